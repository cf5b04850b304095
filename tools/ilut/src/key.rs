//! The order of colours: 24 bits in which colours near each other are mostly near each other.
//!
//! From the top: four high bits of red, green and blue (the parent), the next two of each (with
//! these, the cell), the lowest two of each (the place in the cell).

/// Number of cells: 64 steps of each channel.
pub(crate) const CELLS: usize = 1 << 18;
/// Colours of a cell, and cells of a parent.
pub(crate) const PLACES: usize = 64;

/// Bits of a channel's byte spread over the key, for the channel that comes last.
const SPREAD: [u32; 256] = {
    let mut spread = [0; 256];
    let (mut byte, mut bits) = (0, 0);
    while byte < 256 {
        spread[byte] = (bits >> 4) << 12 | (bits >> 2 & 3) << 6 | bits & 3;
        byte += 1;
        bits += 1;
    }
    spread
};

/// As [`SPREAD`], for red, green and blue.
const SPREADS: [[u32; 256]; 3] = {
    let mut spreads = [SPREAD; 3];
    let mut byte = 0;
    while byte < 256 {
        let bits = SPREAD[byte];
        let (high, middle, low) = (bits >> 12, bits >> 6 & 3, bits & 3);
        spreads[0][byte] = high << 20 | middle << 10 | low << 4;
        spreads[1][byte] = high << 16 | middle << 8 | low << 2;
        byte += 1;
    }
    spreads
};

/// Key of a colour, 24 bits; alpha is not in it.
#[inline(always)]
pub(crate) fn key([red, green, blue, _]: [u8; 4]) -> u32 {
    SPREADS[0][usize::from(red)] | SPREADS[1][usize::from(green)] | SPREADS[2][usize::from(blue)]
}

/// Cell of the colour with `key`.
pub(crate) fn cell(key: u32) -> u32 {
    key >> 6
}

/// Parent of a cell.
pub(crate) fn parent(cell: u32) -> u32 {
    cell >> 6
}

/// The darkest colour of a cell.
pub(crate) fn base(cell: u32) -> [u8; 3] {
    color(cell << 6)
}

/// The colour that has `key`.
#[expect(clippy::cast_possible_truncation, reason = "eight bits are left")]
pub(crate) fn color(key: u32) -> [u8; 3] {
    let channel = |at: u32| {
        let high = key >> (12 + 4 * at) & 15;
        let middle = key >> (6 + 2 * at) & 3;
        (high << 4 | middle << 2 | key >> (2 * at) & 3) as u8
    };
    [channel(2), channel(1), channel(0)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_is_parent_then_cell_then_place() {
        // 0x12 = 0001 00 10, 0xab = 1010 10 11, 0xfc = 1111 11 00.
        assert_eq!(key([0x12, 0xab, 0xfc, 0]), 0b0001_1010_1111_0010_1110_1100);
    }

    #[test]
    fn every_color_has_its_own_key() {
        for byte in 0..=255 {
            for color in [[byte, 0, 0], [0, byte, 0], [0, 0, byte], [byte, byte ^ 0x5a, !byte]] {
                let [red, green, blue] = color;
                assert_eq!(super::color(key([red, green, blue, 7])), color);
            }
        }
    }
}
