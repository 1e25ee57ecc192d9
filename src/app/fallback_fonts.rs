//! Fonts for characters that the app's typeface lacks, such as a scenario's name in Japanese.
//!
//! In: the text that egui has drawn. Out: fonts of the system, added to egui's behind the app's typeface.

use std::collections::HashSet;

use bevy::prelude::*;
use bevy::tasks::{AsyncComputeTaskPool, Task, block_on, poll_once};
use bevy_egui::{EguiContext, EguiFullOutput};
use egui::epaint::text::{FontInsert, FontPriority, InsertFontFamily};
use egui::{FontData, FontFamily, FontId, Shape};

use crate::report::fonts::{SystemFont, system_font_with};

/// The characters that were looked for, and the search in progress.
#[derive(Resource, Default)]
pub struct FallbackFonts {
    searched: HashSet<char>,
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
        let mut missing = HashSet::new();
        for clipped in &output.shapes {
            collect_missing(context, &clipped.shape, &fallback.searched, &mut missing);
        }
        if !missing.is_empty() {
            fallback.searched.extend(&missing);
            fallback.search = Some(AsyncComputeTaskPool::get().spawn(async move { fonts_with(missing) }));
        }
    }
}

/// Adds the characters of `shape` that no font of the app has to `missing`, unless they were searched for before.
fn collect_missing(
    context: &egui::Context,
    shape: &Shape,
    searched: &HashSet<char>,
    missing: &mut HashSet<char>,
) {
    match shape {
        Shape::Vec(shapes) => {
            shapes.iter().for_each(|shape| collect_missing(context, shape, searched, missing));
        }
        Shape::Text(text) if !text.galley.text().is_ascii() => {
            let unknown = |c: &char| !c.is_ascii() && !searched.contains(c);
            let mut fonts = text.galley.text().chars().filter(unknown).peekable();
            if fonts.peek().is_some() {
                context.fonts_mut(|fonts_view| {
                    missing.extend(fonts.filter(|&c| !fonts_view.has_glyph(&FontId::default(), c)));
                });
            }
        }
        _ => {}
    }
}

/// As few fonts as have these characters, of those that have one.
fn fonts_with(characters: HashSet<char>) -> Vec<SystemFont> {
    let mut fonts: Vec<SystemFont> = Vec::new();
    let mut characters: Vec<char> = characters.into_iter().collect();
    characters.sort_unstable();
    for font in characters.into_iter().filter_map(system_font_with) {
        if fonts.iter().all(|other| other.name != font.name) {
            fonts.push(font);
        }
    }
    fonts
}

fn add_font(context: &egui::Context, font: SystemFont) {
    let data = FontData { index: font.index, ..FontData::from_owned(font.data) };
    let families = [FontFamily::Proportional, FontFamily::Monospace];
    let behind = |family| InsertFontFamily { family, priority: FontPriority::Lowest };
    context.add_font(FontInsert::new(&font.name, data, families.map(behind).to_vec()));
}
