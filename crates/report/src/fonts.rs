//! Fonts: the embedded one, and the system fonts for characters that it lacks.

use std::sync::{Arc, LazyLock};

use resvg::usvg::fontdb::{Database, FaceInfo, ID, Source, Style};
use resvg::usvg::{FallbackSelectionFn, FontResolver};
use skrifa::{FontRef, MetadataProvider};

/// Latin, Greek and mathematical characters with Arial's metrics; `assets/fonts/OFL.txt` is the licence.
const EMBEDDED: &[u8] = include_bytes!("../../../assets/fonts/wayfield-sans.ttf");
/// The family of the embedded font.
pub(crate) const FAMILY: &str = "Wayfield Sans";

/// The embedded font, which stands in for every font family that a figure names.
pub(crate) static FONTS: LazyLock<Arc<Database>> = LazyLock::new(|| {
    let mut fonts = Database::new();
    fonts.load_font_data(EMBEDDED.to_vec());
    fonts.set_sans_serif_family(FAMILY);
    fonts.set_serif_family(FAMILY);
    fonts.set_monospace_family(FAMILY);
    Arc::new(fonts)
});

/// The system fonts. They are searched only for a character that the embedded font lacks.
static SYSTEM: LazyLock<Database> = LazyLock::new(|| {
    let mut fonts = Database::new();
    fonts.load_system_fonts();
    fonts
});

/// A system font.
#[derive(Clone, Debug)]
pub struct SystemFont {
    /// The PostScript name, which identifies the face among all system fonts.
    pub name: String,
    /// The contents of the font file.
    pub data: Vec<u8>,
    /// The index of the face in the file.
    pub index: u32,
}

/// The faces of the system fonts, the preferred ones first.
static FACES: LazyLock<Vec<&'static FaceInfo>> = LazyLock::new(|| {
    let mut faces: Vec<&FaceInfo> = SYSTEM.faces().collect();
    faces.sort_by_cached_key(|face| preference_key(face));
    faces
});

/// For each character, the preferred system font that has an outline for it, without duplicates; characters that no font has
/// are skipped. Upright, regular, proportional and sans-serif fonts are preferred, in this order. The first call reads the
/// names of all fonts, which takes a fraction of a second.
#[must_use]
pub fn system_fonts_with(characters: &[char]) -> Vec<SystemFont> {
    let mut faces: Vec<&FaceInfo> = Vec::new();
    for face in characters.iter().filter_map(|&character| system_face_with(character)) {
        if faces.iter().all(|other| other.post_script_name != face.post_script_name) {
            faces.push(face);
        }
    }
    let font = |face: &FaceInfo| {
        let (data, index) = SYSTEM.with_face_data(face.id, |data, index| (data.to_vec(), index))?;
        Some(SystemFont { name: face.post_script_name.clone(), data, index })
    };
    faces.into_iter().filter_map(font).collect()
}

fn system_face_with(character: char) -> Option<&'static FaceInfo> {
    FACES.iter().copied().find(|face| {
        SYSTEM.with_face_data(face.id, |data, index| has_outline(data, index, character)) == Some(true)
    })
}

/// Sort key: upright first, then the weight nearest to regular, then proportional, then families whose name contains "Sans";
/// then by name, so that the order in which the system lists its fonts does not matter.
fn preference_key(face: &FaceInfo) -> (bool, u16, bool, bool, String) {
    (
        face.style != Style::Normal,
        face.weight.0.abs_diff(400),
        face.monospaced,
        !face.families.iter().any(|(family, _)| family.contains("Sans")),
        face.post_script_name.clone(),
    )
}

fn has_outline(data: &[u8], index: u32, character: char) -> bool {
    FontRef::from_index(data, index).is_ok_and(|font| {
        let glyph = font.charmap().map(character);
        glyph.is_some_and(|glyph| font.outline_glyphs().get(glyph).is_some())
    })
}

/// The font resolver of figures: searches the system fonts for characters that the loaded fonts lack.
pub(crate) fn resolver() -> FontResolver<'static> {
    let select_loaded = FontResolver::default_fallback_selector();
    let select_fallback: FallbackSelectionFn<'static> = Box::new(move |character, excluded, fonts| {
        select_loaded(character, excluded, fonts).or_else(|| load_system_face(character, excluded, fonts))
    });
    FontResolver { select_fallback, ..FontResolver::default() }
}

/// Loads the preferred system font for `character`. `None` if it is one of the `excluded` fonts, which have been tried: if they
/// lack a combining mark, usvg asks for a font with the character before the mark, again and again until it gets `None`.
fn load_system_face(character: char, excluded: &[ID], fonts: &mut Arc<Database>) -> Option<ID> {
    let face = system_face_with(character)?;
    let is_face = |tried: &FaceInfo| tried.post_script_name == face.post_script_name;
    if excluded.iter().any(|&id| fonts.face(id).is_some_and(is_face)) {
        return None;
    }
    let source: Source = face.source.clone();
    let loaded = Arc::make_mut(fonts).load_font_source(source);
    loaded.into_iter().find(|&id| fonts.face(id).is_some_and(|loaded| loaded.index == face.index))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_system_font_that_is_returned_has_the_character() {
        // Without system fonts there is nothing to return; if one has an A, it must be found.
        let has_a = |face: &FaceInfo| {
            SYSTEM.with_face_data(face.id, |data, index| has_outline(data, index, 'A')) == Some(true)
        };
        assert_eq!(system_fonts_with(&['A']).len(), usize::from(SYSTEM.faces().any(has_a)));
        for character in ['A', 'я', '迷', '\u{f8ff}'] {
            for font in system_fonts_with(&[character]) {
                assert!(has_outline(&font.data, font.index, character), "{character}: {}", font.name);
            }
        }
        assert!(has_outline(EMBEDDED, 0, 'A') && !has_outline(EMBEDDED, 0, '迷'));
    }

    #[test]
    fn a_character_for_which_all_fonts_have_been_tried_gets_none() {
        let select = resolver().select_fallback;
        let mut fonts = Arc::clone(&FONTS);
        let mut tried: Vec<ID> = fonts.faces().map(|face| face.id).collect();
        while let Some(id) = select('A', &tried, &mut fonts) {
            tried.push(id);
            assert!(tried.len() < 100, "the same system font is loaded again and again");
        }
    }

    #[test]
    fn the_embedded_font_has_every_character_that_figures_use() {
        for character in "−±εαβγσµμΔ·≥≤≈°%–—…→×²₁‘’“”".chars() {
            assert!(has_outline(EMBEDDED, 0, character), "{character} is missing");
        }
    }
}
