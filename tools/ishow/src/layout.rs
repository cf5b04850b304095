//! `Screen`: the place for a picture, and the picture's size there.

use crate::Colors;

/// What is known of a terminal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Screen {
    /// Columns and rows of characters that the picture may take.
    pub cells: [u32; 2],
    /// Width and height of a character in pixels.
    pub cell: [u32; 2],
    /// Whether small pictures are enlarged to fill it.
    pub fill: bool,
    /// Colours of characters.
    pub colors: Colors,
    /// Colours of a sixel picture.
    pub registers: usize,
}

impl Screen {
    /// A usual character, where the terminal does not tell.
    pub const USUAL_CELL: [u32; 2] = [8, 16];
    /// Colours of a sixel picture, where the terminal does not tell.
    pub const USUAL_REGISTERS: usize = 256;

    /// Columns and rows of pixels for a picture of `size`: with its aspect, inside the screen,
    /// and at most its own unless it is to fill the screen.
    pub fn pixels(&self, size: [u32; 2]) -> [u32; 2] {
        let most = [0, 1].map(|axis| f64::from(self.cells[axis]) * f64::from(self.cell[axis]));
        self.fitted(size.map(f64::from), most)
    }

    /// Columns and rows of half blocks for a picture of `size`, as [`Screen::pixels`].
    pub fn blocks(&self, size: [u32; 2]) -> [u32; 2] {
        // A block is half as high as a character.
        let aspect = f64::from(self.cell[1]) / (2.0 * f64::from(self.cell[0]));
        let most = [f64::from(self.cells[0]), 2.0 * f64::from(self.cells[1])];
        self.fitted([f64::from(size[0]), f64::from(size[1]) / aspect], most)
    }

    fn fitted(&self, size: [f64; 2], most: [f64; 2]) -> [u32; 2] {
        let scales = [most[0] / size[0], most[1] / size[1]];
        let scale = if scales[0] < scales[1] { scales[0] } else { scales[1] };
        let scale = if scale > 1.0 && !self.fill { 1.0 } else { scale };
        [0, 1].map(|axis| whole((size[axis] * scale).round().clamp(1.0, most[axis].floor())))
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a whole number from 1 to the size of a screen"
)]
fn whole(value: f64) -> u32 {
    value as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCREEN: Screen = Screen {
        cells: [80, 24],
        cell: [10, 20],
        fill: false,
        colors: Colors::True,
        registers: 256,
    };

    #[test]
    fn large_pictures_shrink_with_their_aspect() {
        // 800 x 480 pixels.
        assert_eq!(SCREEN.pixels([1600, 400]), [800, 200]);
        assert_eq!(SCREEN.pixels([500, 960]), [250, 480]);
        assert_eq!(SCREEN.pixels([1_000_000, 1]), [800, 1]);
        // 80 x 48 blocks of 10 x 10.
        assert_eq!(SCREEN.blocks([1600, 400]), [80, 20]);
        assert_eq!(SCREEN.blocks([500, 960]), [25, 48]);
    }

    #[test]
    fn small_pictures_stay_unless_they_fill_the_screen() {
        assert_eq!(SCREEN.pixels([30, 20]), [30, 20]);
        assert_eq!(SCREEN.blocks([30, 20]), [30, 20]);
        let filled = Screen { fill: true, ..SCREEN };
        assert_eq!(filled.pixels([30, 20]), [720, 480]);
        assert_eq!(filled.blocks([30, 20]), [72, 48]);
    }

    #[test]
    fn blocks_keep_the_aspect_of_narrow_characters() {
        // A block of 8 x 9: 9/8 as high as wide, so fewer rows.
        let narrow = Screen { cell: [8, 18], ..SCREEN };
        assert_eq!(narrow.blocks([36, 36]), [36, 32]);
    }
}
