//! Colours that were changed a moment ago: in one place of a picture the same ones come again.

use crate::color::{Bytes, Turn};

/// Pixels that are looked up before those that are new are worked on together.
const CHUNK: usize = 1024;

/// Chunks that are worked on as they are where nearly all colours are new, as in noise.
const PAUSE: usize = 8;

/// Set in what is known, so that nothing is taken for black.
const KNOWN: u32 = 1 << 24;

/// Changes colours as [`Bytes::change`] does, to the byte, and remembers them: 2^15 of them, by the
/// low bits of their channels, so that neighbours do not drive each other out.
pub(crate) struct Recent {
    /// A colour and what it becomes.
    known: Vec<[u32; 2]>,
    /// Chunks to go without a look.
    pause: usize,
}

impl Recent {
    /// Nothing is known.
    pub(crate) fn new() -> Self {
        Self { known: vec![[0; 2]; 1 << 15], pause: 0 }
    }

    /// Changes colours in place.
    pub(crate) fn change(&mut self, bytes: &Bytes, [r, g, b]: [&mut [u8]; 3], turn: &Turn) {
        let chunks = r.chunks_mut(CHUNK).zip(g.chunks_mut(CHUNK)).zip(b.chunks_mut(CHUNK));
        for ((r, g), b) in chunks {
            if self.pause > 0 {
                self.pause -= 1;
                bytes.change([r, g, b], turn);
            } else {
                self.change_chunk(bytes, [r, g, b], turn);
            }
        }
    }

    fn change_chunk(&mut self, bytes: &Bytes, [r, g, b]: [&mut [u8]; 3], turn: &Turn) {
        let (mut places, mut missed) = ([0; CHUNK], [0; CHUNK]);
        let mut count = 0;
        for (at, ((r, g), b)) in r.iter_mut().zip(&mut *g).zip(&mut *b).enumerate() {
            let color = u32::from_le_bytes([*r, *g, *b, 0]);
            let [known, new] = self.known[place(color)];
            // Written over below where the colour is another; no branch to go wrong.
            [*r, *g, *b, _] = new.to_le_bytes();
            (places[count], missed[count]) = (at, color);
            count += usize::from(known != color | KNOWN);
        }
        let (places, missed) = (&places[..count], &missed[..count]);
        let mut planes = [0, 1, 2].map(|channel| {
            missed.iter().map(|color| color.to_le_bytes()[channel]).collect::<Vec<u8>>()
        });
        let [reds, greens, blues] = &mut planes;
        bytes.change([reds, greens, blues], turn);
        for (index, (&at, &color)) in places.iter().zip(missed).enumerate() {
            let new = [reds[index], greens[index], blues[index]];
            [r[at], g[at], b[at]] = new;
            let [red, green, blue] = new;
            self.known[place(color)] = [color | KNOWN, u32::from_le_bytes([red, green, blue, 0])];
        }
        if count > r.len() - r.len() / 4 {
            self.pause = PAUSE;
        }
    }
}

/// Where a colour is remembered.
fn place(color: u32) -> usize {
    let low = |shift: u32| (color >> shift) & 31;
    (low(0) | low(8) << 5 | low(16) << 10) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color;
    use idf::Transfer;

    #[test]
    fn what_is_remembered_is_what_would_be_made() {
        let bytes = Bytes::new(Transfer::Srgb);
        let mut seed = 1_u32;
        let mut byte = |range: u32| {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            ((u64::from(seed) * u64::from(range)) >> 32).to_le_bytes()[0]
        };
        // Few colours, that come again; colours that drive each other out; noise; black.
        let mut colors: Vec<[u8; 3]> = Vec::new();
        colors.extend((0..5000).map(|_| [byte(6), byte(6), byte(6)]));
        colors.extend((0..5000).map(|_| [byte(8) << 5, byte(8) << 5, 7]));
        colors.extend((0..9000).map(|_| [byte(256), byte(256), byte(256)]));
        colors.extend((0..3000).map(|at| if at % 3 == 0 { [0; 3] } else { [0, 0, 32] }));
        for turn in [color::saturation(&[1.7]), color::saturation(&[0.0]), color::hue(&[90.0])] {
            let planes = [0, 1, 2].map(|c| colors.iter().map(|color| color[c]).collect());
            let [mut r, mut g, mut b]: [Vec<u8>; 3] = planes.clone();
            let mut recent = Recent::new();
            // By parts, as threads get them.
            for ((r, g), b) in r.chunks_mut(7001).zip(g.chunks_mut(7001)).zip(b.chunks_mut(7001)) {
                recent.change(&bytes, [r, g, b], &turn);
            }
            let [mut plain_r, mut plain_g, mut plain_b] = planes;
            bytes.change([&mut plain_r, &mut plain_g, &mut plain_b], &turn);
            assert!(r == plain_r && g == plain_g && b == plain_b, "{turn:?}");
        }
    }
}
