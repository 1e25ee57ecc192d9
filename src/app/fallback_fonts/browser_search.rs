//! Fonts that the page makes from what the browser draws, because it cannot read the system's font files.

use egui::FontData;

use crate::app::page;

/// Fonts by name.
pub(super) type FoundFonts = Vec<(String, FontData)>;

/// The maximum number of characters in one font. The page takes a few milliseconds to draw a character.
const MAX_CHARACTERS: usize = 20;

/// The font that the page has made, if it could.
pub(super) struct FontSearch(FoundFonts);

impl FontSearch {
    /// Lets the page make a font with the first characters of `missing`, and removes these characters from `missing`.
    pub(super) fn start(missing: &mut Vec<char>) -> Self {
        let characters: String = missing.drain(..missing.len().min(MAX_CHARACTERS)).collect();
        let font = page::font_with(&characters).map(FontData::from_owned);
        Self(font.map(|font| (format!("browser: {characters}"), font)).into_iter().collect())
    }

    /// The font, if the page could make one. Never `Err`: the search has finished already.
    pub(super) fn poll(self) -> Result<FoundFonts, Self> {
        Ok(self.0)
    }
}
