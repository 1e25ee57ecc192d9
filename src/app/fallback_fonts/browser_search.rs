//! Fonts that the page makes of what the browser draws: it cannot read the files of the system's fonts.

use egui::FontData;

use crate::app::page;

/// Fonts by name.
pub(super) type FoundFonts = Vec<(String, FontData)>;

/// The maximum number of characters in one font. Drawing one takes the page a few milliseconds.
const MAX_CHARACTERS: usize = 20;

/// A font that the page has made, if it can.
pub(super) struct FontSearch(FoundFonts);

impl FontSearch {
    /// Lets the page make a font with the first of these characters, and removes them.
    pub(super) fn start(missing: &mut Vec<char>) -> Self {
        let characters: String = missing.drain(..missing.len().min(MAX_CHARACTERS)).collect();
        let font = page::font_with(&characters).map(FontData::from_owned);
        Self(font.map(|font| (format!("browser: {characters}"), font)).into_iter().collect())
    }

    /// The font.
    ///
    /// # Errors
    /// None.
    pub(super) fn poll(self) -> Result<FoundFonts, Self> {
        Ok(self.0)
    }
}
