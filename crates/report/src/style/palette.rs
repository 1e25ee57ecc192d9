//! The colours of all figures: Okabe and Ito's palette, which is safe for colour-blind readers.

use plotters::prelude::RGBColor;

pub(crate) const GREEN: RGBColor = RGBColor(0, 158, 115);
pub(crate) const BLUE: RGBColor = RGBColor(0, 114, 178);
pub(crate) const VERMILION: RGBColor = RGBColor(213, 94, 0);
pub(crate) const INK: RGBColor = RGBColor(34, 34, 34);
pub(crate) const SOFT_INK: RGBColor = RGBColor(96, 96, 96);
pub(crate) const GRID: RGBColor = RGBColor(226, 226, 226);

const PALETTE: [RGBColor; 7] =
    [BLUE, VERMILION, GREEN, RGBColor(204, 121, 167), RGBColor(230, 159, 0), RGBColor(86, 180, 233), INK];

/// The number of colours in the palette.
pub(super) const COUNT: usize = PALETTE.len();

/// The palette's colour at `index`, modulo the palette's length.
pub(crate) fn colour(index: usize) -> RGBColor {
    PALETTE[index % COUNT]
}
