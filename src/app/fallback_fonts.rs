//! Fonts for characters that the app's typeface lacks, such as a scenario's name in Japanese.
//!
//! In: the text that egui has drawn. Out: fonts of the system, added to egui's behind the app's typeface.

use std::collections::HashSet;

use bevy::prelude::*;
use bevy::tasks::{AsyncComputeTaskPool, Task, block_on, poll_once};
use bevy_egui::{EguiContext, EguiFullOutput};
use egui::epaint::text::{FontInsert, FontPriority, InsertFontFamily};
use egui::{FontData, FontFamily, FontId, Shape};

use crate::report::fonts::{SystemFont, system_fonts_with};

/// The characters that were checked, and the search in progress.
#[derive(Resource, Default)]
pub struct FallbackFonts {
    checked: HashSet<char>,
    search: Option<Task<Vec<SystemFont>>>,
}

impl FallbackFonts {
    /// Whether text is displayed whose font is still being looked for.
    pub fn is_searching(&self) -> bool {
        self.search.is_some()
    }
}

/// Looks for fonts with the characters that were drawn as the sign for a missing glyph. The search runs in the background.
pub fn add_fallback_fonts(
    mut contexts: Query<(&mut EguiContext, &EguiFullOutput)>,
    mut fallback: ResMut<FallbackFonts>,
) {
    for (mut context, output) in &mut contexts {
        let Some(output) = &output.0 else { continue };
        let context = context.get_mut();
        if let Some(search) = &mut fallback.search {
            let Some(found) = block_on(poll_once(search)) else { continue };
            fallback.search = None;
            found.into_iter().for_each(|font| add_font(context, font));
        }
        let mut missing = Vec::new();
        for clipped in &output.shapes {
            collect_missing(context, &clipped.shape, &mut fallback.checked, &mut missing);
        }
        if !missing.is_empty() {
            fallback.search =
                Some(AsyncComputeTaskPool::get().spawn(async move { system_fonts_with(&missing) }));
        }
    }
}

/// Adds the characters of `shape` that no font of the app has to `missing`. Each character is checked once.
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

fn add_font(context: &egui::Context, font: SystemFont) {
    let data = FontData { index: font.index, ..FontData::from_owned(font.data) };
    let families = [FontFamily::Proportional, FontFamily::Monospace];
    let behind = |family| InsertFontFamily { family, priority: FontPriority::Lowest };
    context.add_font(FontInsert::new(&font.name, data, families.map(behind).to_vec()));
}
