//! The controls of the editor's panel: rows of a name and its numbers, in the units that people read.
//!
//! In: a copy of the thing that is edited. Out: the copy changed, and which field it was, so that what is typed in one
//! field is one step for undo.

use bevy::math;
use egui::{Align, ComboBox, DragValue, Id, Label, Layout, Response, RichText, Ui, vec2};

use crate::app::editor::Editor;
use crate::app::screen::theme::{BODY, Palette};
use crate::app::screen::widgets::icons::{self, ButtonStyle, Icon};
use crate::app::screen::widgets::text::weak_text;
use crate::scenario::Scenario;

/// The width of a number's box.
const BOX: f32 = 66.0;
/// The height of a row.
const HEIGHT: f32 = 24.0;
/// The most corners of a list that are shown as numbers.
const MAX_SHOWN: usize = 32;

/// How a number is read, and between what it may be set.
#[derive(Clone, Copy, Debug)]
pub struct NumberSpec {
    suffix: &'static str,
    /// What is shown for one of what is stored.
    factor: f64,
    /// Decimals of what is stored.
    stored: i32,
    /// Decimals of what is shown, at least and at most.
    shown: (usize, usize),
    /// What is stored is changed by so much for each point that is dragged.
    speed: f64,
    least: f64,
    most: f64,
}

impl NumberSpec {
    /// A coordinate, in m.
    pub const POSITION: Self = Self::format_metres(-500.0, 500.0);
    /// An angle: stored in rad, shown in degrees.
    pub const ANGLE: Self = Self {
        suffix: "°",
        factor: DEGREES,
        stored: 4,
        shown: (0, 1),
        speed: 0.017,
        least: -TURN,
        most: TURN,
    };
    /// A speed along a way, in m/s.
    pub const SPEED: Self =
        Self { suffix: " m/s", factor: 1.0, stored: 3, shown: (2, 3), speed: 0.005, least: 0.0, most: 5.0 };
    /// A speed of turning: stored in rad/s, shown in degrees per second.
    pub const ANGULAR_VELOCITY: Self = Self {
        suffix: " °/s",
        factor: DEGREES,
        stored: 4,
        shown: (0, 1),
        speed: 0.01,
        least: -20.0,
        most: 20.0,
    };
    /// A share of one, shown in percent.
    pub const FRACTION: Self =
        Self { suffix: "%", factor: 100.0, stored: 4, shown: (0, 2), speed: 0.005, least: 0.0, most: 1.0 };

    /// A length, in m.
    pub const fn format_metres(least: f64, most: f64) -> Self {
        Self { suffix: " m", factor: 1.0, stored: 3, shown: (2, 3), speed: 0.01, least, most }
    }

    /// A time, in s.
    pub const fn seconds(least: f64, most: f64) -> Self {
        Self { suffix: " s", factor: 1.0, stored: 3, shown: (1, 3), speed: 0.01, least, most }
    }

    /// The same between other bounds, in what is stored.
    pub const fn with_range(self, least: f64, most: f64) -> Self {
        Self { least, most, ..self }
    }
}

const DEGREES: f64 = 180.0 / std::f64::consts::PI;
/// A full turn, in rad, as far as a file may say it.
const TURN: f64 = std::f64::consts::TAU;

/// Rows of fields of one thing.
pub struct FieldRows<'u> {
    /// Where they are drawn.
    pub ui: &'u mut Ui,
    touched: Option<String>,
    left: bool,
}

impl<'u> FieldRows<'u> {
    /// Begins.
    pub fn new(ui: &'u mut Ui) -> Self {
        Self { ui, touched: None, left: false }
    }

    /// Carries over what was changed, if anything was; `of` is what the fields belong to.
    pub fn commit(self, editor: &mut Editor, of: &str, change: impl FnOnce(&mut Scenario)) {
        if let Some(field) = self.touched {
            editor.edit(&format!("{of}: {field}"), change);
        }
        if self.left {
            editor.close_group();
        }
    }

    /// A name, and what is put on the right of it.
    fn row(&mut self, name: &str, tip: &str, right: impl FnOnce(&mut Ui, Id) -> (bool, bool)) {
        let (touched, left) = self
            .ui
            .horizontal(|ui| {
                ui.set_height(HEIGHT);
                ui.spacing_mut().button_padding.x = 4.0;
                let row = ui.max_rect();
                let label = hinted(ui.add(Label::new(weak_text(name)).selectable(false)), tip);
                let rest = vec2((row.right() - ui.cursor().left()).max(0.0), HEIGHT);
                let right = |ui: &mut Ui| right(ui, label.id);
                ui.allocate_ui_with_layout(rest, Layout::right_to_left(Align::Center), right).inner
            })
            .inner;
        if touched {
            self.touched = Some(name.to_owned());
        }
        self.left |= left;
    }

    /// A row of one number.
    pub fn number(&mut self, name: &str, tip: &str, value: &mut f32, unit: NumberSpec) {
        self.row(name, tip, |ui, label| number(ui, Name::Label(label), tip, value, unit));
    }

    /// A row of two numbers, with what each is called.
    pub fn pair(&mut self, name: &str, tip: &str, both: [(&str, &mut f32); 2], unit: NumberSpec) {
        self.row(name, tip, |ui, _| two(ui, name, tip, both, [unit; 2]));
    }

    /// A row of a place.
    pub fn position(&mut self, name: &str, tip: &str, math::Vec2 { x, y }: &mut math::Vec2) {
        self.pair(name, tip, [("x", x), ("y", y)], NumberSpec::POSITION);
    }

    /// A list with two numbers each, and a cross to take each out while more than `least` are there. Of a long one
    /// `further` says how the rest is changed.
    pub fn list<T>(
        &mut self,
        name: &str,
        all: &mut Vec<T>,
        least: usize,
        further: &str,
        units: [NumberSpec; 2],
        both: impl for<'t> Fn(&'t mut T) -> [(&'static str, &'t mut f32); 2],
    ) {
        let mut gone = None;
        let many = all.len();
        for (k, one) in all.iter_mut().enumerate().take(MAX_SHOWN) {
            let name = format!("{name} {}", k + 1);
            self.row(&name, "", |ui, _| {
                let done = two(ui, &name, "", both(one), units);
                if many > least {
                    let what = format!("Remove {}", name.to_lowercase());
                    if icons::icon_button_ui(ui, Icon::Close, ButtonStyle::Quiet, 16.0, &what, &what)
                        .clicked()
                    {
                        gone = Some(k);
                    }
                }
                done
            });
        }
        if let Some(k) = gone {
            all.remove(k);
            self.mark_changed(&format!("{name} out"));
        }
        if let Some(more @ 1..) = many.checked_sub(MAX_SHOWN) {
            self.ui.label(weak_text(&format!("and {more} more: {further}")));
        }
    }

    /// A list of places.
    pub fn positions(&mut self, name: &str, places: &mut Vec<math::Vec2>, least: usize) {
        let further = "drag them in the world";
        self.list(name, places, least, further, [NumberSpec::POSITION; 2], |math::Vec2 { x, y }| {
            [("x", x), ("y", y)]
        });
    }

    /// Something was changed otherwise, and at once.
    pub fn mark_changed(&mut self, field: &str) {
        (self.touched, self.left) = (Some(field.to_owned()), true);
    }

    /// A row of a whole number.
    pub fn count<T: egui::emath::Numeric>(
        &mut self,
        name: &str,
        tip: &str,
        value: &mut T,
        range: std::ops::RangeInclusive<T>,
    ) {
        self.row(name, tip, |ui, label| {
            let before = value.to_f64();
            let field = DragValue::new(value).range(range).clamp_existing_to_range(false).speed(0.1);
            let response = ui.add_sized(vec2(BOX, HEIGHT), field).labelled_by(label);
            let touched = value.to_f64() != before;
            (touched, is_left(&hinted(response, tip)))
        });
    }

    /// A tick.
    pub fn checkbox(&mut self, name: &str, tip: &str, value: &mut bool) {
        let palette = Palette::from_ui(self.ui);
        let on = *value;
        let response = self.ui.scope(|ui| {
            let widgets = &mut ui.visuals_mut().widgets;
            for look in [&mut widgets.inactive, &mut widgets.hovered, &mut widgets.active] {
                if on {
                    (look.bg_fill, look.fg_stroke.color) = (palette.accent, palette.on_accent);
                }
            }
            ui.checkbox(value, weak_text(name))
        });
        if hinted(response.inner, tip).changed() {
            self.mark_changed(name);
        }
    }
}

/// Two boxes, in a row that goes from right to left.
fn two(
    ui: &mut Ui,
    name: &str,
    tip: &str,
    [(first, a), (second, b)]: [(&str, &mut f32); 2],
    units: [NumberSpec; 2],
) -> (bool, bool) {
    let b = number(ui, Name::Words(format!("{name} {second}")), tip, b, units[1]);
    let a = number(ui, Name::Words(format!("{name} {first}")), tip, a, units[0]);
    (a.0 || b.0, a.1 || b.1)
}

/// What a screen reader calls a box.
enum Name {
    /// What the label beside it says.
    Label(Id),
    Words(String),
}

/// A number's box; whether it was changed, and whether it was left.
fn number(ui: &mut Ui, name: Name, tip: &str, value: &mut f32, unit: NumberSpec) -> (bool, bool) {
    let mut shown = f64::from(*value) * unit.factor;
    let before = shown;
    // A number that is already beyond the bounds stays where it is until it is changed.
    let (least, most) = (before.min(unit.least * unit.factor), before.max(unit.most * unit.factor));
    let field = DragValue::new(&mut shown)
        .speed(unit.speed * unit.factor)
        .range(least..=most)
        .clamp_existing_to_range(false)
        .custom_formatter(move |value, _| written(value, unit.shown))
        .suffix(unit.suffix);
    let response = ui.add_sized(vec2(BOX, HEIGHT), field);
    let response = match name {
        Name::Label(label) => response.labelled_by(label),
        Name::Words(words) => {
            set_accessible_name(&response, &words);
            response
        }
    };
    // A box that is left reads its own text, which has fewer decimals than what is stored.
    let touched = written(shown, unit.shown) != written(before, unit.shown);
    if touched {
        let steps = 10_f64.powi(unit.stored);
        *value = ((shown / unit.factor * steps).round() / steps) as f32 + 0.0;
    }
    (touched, is_left(&hinted(response, tip)))
}

/// A number with no more decimals than it has.
fn written(value: f64, (least, most): (usize, usize)) -> String {
    let mut text = format!("{value:.most$}");
    for _ in least..most {
        match text.strip_suffix('0') {
            Some(shorter) => text.truncate(shorter.len()),
            None => return text,
        }
    }
    text.truncate(text.trim_end_matches('.').len());
    text
}

fn is_left(response: &Response) -> bool {
    response.lost_focus() || response.drag_stopped()
}

/// The control with a hint, if there is one.
fn hinted(response: Response, tip: &str) -> Response {
    if tip.is_empty() { response } else { response.on_hover_text(tip) }
}

/// Gives a control a name for screen readers.
pub fn set_accessible_name(response: &Response, name: &str) {
    response.ctx.accesskit_node_builder(response.id, |node| node.set_label(name));
}

/// A row of a few kinds to choose from; answers with another one that was chosen.
pub fn choice_ui<T: Copy + PartialEq>(ui: &mut Ui, name: &str, now: T, all: &[(T, &str, &str)]) -> Option<T> {
    let mut chosen = None;
    ui.horizontal(|ui| {
        let label = ui.label(weak_text(name));
        let width = (2.0 * BOX + ui.spacing().item_spacing.x).min(ui.available_width());
        let text = all.iter().find(|(kind, ..)| *kind == now).map_or("", |(_, text, _)| *text);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let combo = ComboBox::from_id_salt(name).width(width).selected_text(text).truncate();
            let shown = combo.show_ui(ui, |ui| {
                for &(kind, text, about) in all {
                    if ui.selectable_label(kind == now, text).on_hover_text(about).clicked() {
                        chosen = Some(kind);
                    }
                }
            });
            shown.response.labelled_by(label.id);
        });
    });
    chosen.filter(|&kind| kind != now)
}

/// A few buttons in a row, as wide as the panel; answers with the one that was pressed. Each has a text, what it does,
/// and whether it can be pressed.
pub fn button_row_ui(ui: &mut Ui, all: &[(&str, &str, bool)]) -> Option<usize> {
    let mut pressed = None;
    let gaps = ui.spacing().item_spacing.x * all.len().saturating_sub(1) as f32;
    let width = (ui.available_width() - gaps) / all.len().max(1) as f32;
    ui.horizontal(|ui| {
        for (k, (text, tip, can)) in all.iter().enumerate() {
            ui.add_enabled_ui(*can, |ui| {
                let button = egui::Button::new(RichText::new(*text).size(BODY));
                let response = ui.add_sized(vec2(width, 26.0), button);
                if response.on_hover_text(*tip).on_disabled_hover_text(*tip).clicked() {
                    pressed = Some(k);
                }
            });
        }
    });
    pressed
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_no_more_decimals_than_needed() {
        assert_eq!(
            [0.15, 0.125, 4.0, -1.2].map(|value| written(value, (2, 3))),
            ["0.15", "0.125", "4.00", "-1.20"]
        );
        assert_eq!([30.0, 0.06, -85.94].map(|value| written(value, (0, 1))), ["30", "0.1", "-85.9"]);
        assert_eq!([100.0, 2.5, 0.0].map(|value| written(value, (0, 2))), ["100", "2.5", "0"]);
    }
}
