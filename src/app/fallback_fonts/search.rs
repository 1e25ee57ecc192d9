//! A search of the system's fonts, in the background.

use bevy::tasks::{AsyncComputeTaskPool, Task, block_on, poll_once};
use egui::FontData;

use crate::report::fonts::{SystemFont, system_fonts_with};

/// The fonts found, each with its name.
pub(super) type FoundFonts = Vec<(String, FontData)>;

/// A search in progress.
pub(super) struct FontSearch(Task<Vec<SystemFont>>);

impl FontSearch {
    /// Begins to search for fonts with the characters in `missing`, and empties it.
    pub(super) fn start(missing: &mut Vec<char>) -> Self {
        let missing = std::mem::take(missing);
        Self(AsyncComputeTaskPool::get().spawn(async move { system_fonts_with(&missing) }))
    }

    /// The fonts, or the search itself while it has not finished.
    pub(super) fn poll(mut self) -> Result<FoundFonts, Self> {
        let Some(found) = block_on(poll_once(&mut self.0)) else { return Err(self) };
        let data =
            |font: SystemFont| (font.name, FontData { index: font.index, ..FontData::from_owned(font.data) });
        Ok(found.into_iter().map(data).collect())
    }
}
