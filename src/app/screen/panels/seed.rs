//! The seed field of the setup panel, with a button for a random seed.

use egui::{DragValue, Ui, vec2};

use crate::app::screen::widgets::icons::{self, ButtonStyle, Icon};
use crate::app::screen::widgets::text::section_title_ui;

/// Draws the field for `seed`.
pub(super) fn seed_ui(ui: &mut Ui, seed: &mut u64) {
    let label = section_title_ui(ui, "Seed");
    ui.horizontal(|ui| {
        let side = ui.spacing().interact_size.y;
        let width = ui.available_width() - side - ui.spacing().item_spacing.x;
        // The field works with an f64, which is not exact above 2^53: show the seed itself while they agree.
        let current = *seed;
        let format = move |shown: f64, _| {
            if shown == current as f64 { current.to_string() } else { format!("{shown:.0}") }
        };
        ui.add_sized(vec2(width, side), DragValue::new(seed).speed(1.0).custom_formatter(format))
            .labelled_by(label.id)
            .on_hover_text("The same seed gives the same training; drag, or click to type");
        let name = "Random seed";
        if icons::icon_button_ui(ui, Icon::Dice, ButtonStyle::Framed, side, name, name).clicked() {
            *seed = random_seed(current, ui.input(|i| i.time));
        }
    });
}

/// A seed of up to six digits other than `before`: splitmix64 of `before` and the time.
fn random_seed(before: u64, time_s: f64) -> u64 {
    let mut z = before ^ time_s.to_bits().wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    let seed = (z ^ (z >> 31)) % 1_000_000;
    if seed == before { seed + 1 } else { seed }
}
