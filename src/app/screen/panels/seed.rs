//! The seed field of the setup panel, with a button for a random seed.

use std::cell::RefCell;

use egui::{DragValue, Ui, vec2};

use crate::app::screen::widgets::icons::{self, ButtonStyle, Icon};
use crate::app::screen::widgets::text::{note_ui, section_title_ui};
use crate::app::setup_form::SetupForm;

/// The maximum number of characters of a rejected text that its message repeats.
const MAX_REPEATED: usize = 24;

/// Draws the field for the seed of `form`. Text that is not a seed is rejected with a message below the field.
pub(super) fn seed_ui(ui: &mut Ui, form: &mut SetupForm) {
    let label = section_title_ui(ui, "Seed");
    ui.horizontal(|ui| {
        let side = ui.spacing().interact_size.y;
        let width = ui.available_width() - side - ui.spacing().item_spacing.x;
        // The field works with an f64, which is not exact above 2^53: show and keep the seed itself.
        let current = form.seed;
        let format = move |shown: f64, _| {
            if shown == current as f64 { current.to_string() } else { format!("{shown:.0}") }
        };
        let typed = RefCell::new(None);
        let parse = |text: &str| {
            let parsed = parse_seed(text);
            let value = parsed.as_ref().ok().map(|&seed| seed as f64);
            *typed.borrow_mut() = Some(parsed);
            value
        };
        let field = DragValue::new(&mut form.seed).speed(1.0).custom_formatter(format).custom_parser(parse);
        let field = ui.add_sized(vec2(width, side), field).labelled_by(label.id);
        let field = field.on_hover_text("The same seed gives the same training run; drag, or click to type");
        match typed.into_inner() {
            Some(Ok(seed)) => (form.seed, form.seed_problem) = (seed, None),
            Some(Err(problem)) => form.seed_problem = Some(problem),
            None if field.changed() => form.seed_problem = None,
            None => {}
        }
        let name = "Random seed";
        if icons::icon_button_ui(ui, Icon::Dice, ButtonStyle::Framed, side, name, name).clicked() {
            (form.seed, form.seed_problem) = (random_seed(form.seed, ui.input(|i| i.time)), None);
        }
    });
    if let Some(problem) = &form.seed_problem {
        note_ui(ui, &format!("{problem}. The seed stays {}", form.seed));
    }
}

/// The seed in `text`.
///
/// # Errors
/// The problem, without a full stop.
fn parse_seed(text: &str) -> Result<u64, String> {
    let text = text.trim();
    if text.is_empty() {
        return Err("No number".into());
    }
    text.parse().map_err(|_| {
        let is_number = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
        let problem = match text.strip_prefix('-') {
            Some(digits) if is_number(digits) => "Negative",
            None if is_number(text) => "Too large",
            _ => "Not a whole number",
        };
        let repeated: String = text.chars().take(MAX_REPEATED).collect();
        format!("{problem}: {repeated}")
    })
}

/// A seed of up to six digits other than `before`: splitmix64 of `before` and the time.
fn random_seed(before: u64, time_s: f64) -> u64 {
    let mut z = before ^ time_s.to_bits().wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    let seed = (z ^ (z >> 31)) % 1_000_000;
    if seed == before { (seed + 1) % 1_000_000 } else { seed }
}
