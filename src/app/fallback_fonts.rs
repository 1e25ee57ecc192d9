//! Fonts for characters that the app's typeface lacks, such as those of a scenario's name in Japanese.
//!
//! In: the text that egui has drawn. Out: fonts of the system or, in the browser, of the page, which egui uses where the app's
//! typeface lacks a character.

#[cfg_attr(target_arch = "wasm32", path = "fallback_fonts/browser_search.rs")]
mod search;

use std::collections::HashSet;

use bevy::prelude::*;
use bevy_egui::{EguiContext, EguiFullOutput};
use egui::epaint::text::{FontInsert, FontPriority, InsertFontFamily};
use egui::{FontData, FontFamily, FontId, Shape};

use search::FontSearch;

/// The characters that were checked, those that the app's fonts lack, and the search in progress.
#[derive(Resource, Default)]
pub struct FallbackFonts {
    checked: HashSet<char>,
    missing: Vec<char>,
    search: Option<FontSearch>,
}

impl FallbackFonts {
    /// Whether a font for displayed text is still being searched for.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn is_searching(&self) -> bool {
        self.search.is_some()
    }
}

/// Searches in the background for fonts with the drawn characters that the app's fonts lack, and adds the fonts it finds.
pub fn add_fallback_fonts(
    mut contexts: Query<(&mut EguiContext, &EguiFullOutput)>,
    mut fallback: ResMut<FallbackFonts>,
) {
    let FallbackFonts { checked, missing, search } = &mut *fallback;
    for (mut context, output) in &mut contexts {
        let Some(output) = &output.0 else { continue };
        let context = context.get_mut();
        match search.take().map(FontSearch::poll) {
            Some(Ok(found)) => found.into_iter().for_each(|(name, data)| add_font(context, &name, data)),
            Some(Err(unfinished)) => *search = Some(unfinished),
            None => {}
        }
        for clipped in &output.shapes {
            collect_missing(context, &clipped.shape, checked, missing);
        }
        if search.is_none() && !missing.is_empty() {
            *search = Some(FontSearch::start(missing));
        }
        if search.is_some() {
            context.request_repaint();
        }
    }
}

/// Adds to `missing` the characters of `shape` that no font of the app has. Each character is checked once.
fn collect_missing(
    context: &egui::Context,
    shape: &Shape,
    checked: &mut HashSet<char>,
    missing: &mut Vec<char>,
) {
    match shape {
        Shape::Vec(shapes) => {
            shapes.iter().for_each(|shape| collect_missing(context, shape, checked, missing));
        }
        Shape::Text(text) if !text.galley.text().is_ascii() => {
            let unchecked = text.galley.text().chars().filter(|c| !c.is_ascii() && checked.insert(*c));
            let lacks = |c: &char| !context.fonts_mut(|fonts| fonts.has_glyph(&FontId::default(), *c));
            missing.extend(unchecked.filter(lacks));
        }
        _ => {}
    }
}

fn add_font(context: &egui::Context, name: &str, data: FontData) {
    let families = [FontFamily::Proportional, FontFamily::Monospace];
    let behind = |family| InsertFontFamily { family, priority: FontPriority::Lowest };
    context.add_font(FontInsert::new(name, data, families.map(behind).to_vec()));
}
