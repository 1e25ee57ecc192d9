//! Rows of fields in the editor's panel: a label and one or two numbers each.
//!
//! The fields change a copy of the edited item; [`FieldRows::commit`] applies the copy to the scenario. All changes of
//! one field are one undo step.

use std::ops::RangeInclusive;

use bevy::math;
use egui::{Align, Id, Label, Layout, Response, Sense, TextEdit, Ui, vec2};

use super::number::{FieldEvents, FieldName, HEIGHT, NumberSpec, count_ui, number_ui, with_tip};
use crate::app::editor::Editor;
use crate::app::screen::theme::Palette;
use crate::app::screen::widgets::icons::{self, ButtonStyle, Icon};
use crate::app::screen::widgets::text::weak_text;
use crate::scenario::{RangeNumber, Ranged, Scenario};

/// Maximum number of list entries shown.
pub const MAX_SHOWN: usize = 32;

/// The rows of one item.
pub struct FieldRows<'u> {
    /// The panel.
    pub ui: &'u mut Ui,
    changed_field: Option<String>,
    edit_ended: bool,
}

impl<'u> FieldRows<'u> {
    /// Begins the rows.
    pub fn new(ui: &'u mut Ui) -> Self {
        Self { ui, changed_field: None, edit_ended: false }
    }

    /// Applies `change` if a field was changed; `item` identifies the edited item for undo.
    pub fn commit(self, editor: &mut Editor, item: &str, change: impl FnOnce(&mut Scenario)) {
        if let Some(field) = self.changed_field {
            editor.edit(&format!("{item}: {field}"), change);
        }
        if self.edit_ended {
            editor.close_group();
        }
    }

    /// Adds a label, and fields to the right of it. Returns the response of the label.
    fn row(&mut self, name: &str, tip: &str, fields: impl FnOnce(&mut Ui, Id) -> FieldEvents) -> Response {
        let row = self.ui.horizontal(|ui| {
            ui.set_height(HEIGHT);
            ui.spacing_mut().button_padding.x = 4.0;
            let row = ui.max_rect();
            let label = with_tip(ui.add(Label::new(weak_text(name)).selectable(false)), tip);
            let rest = vec2((row.right() - ui.cursor().left()).max(0.0), HEIGHT);
            let id = label.id;
            let fields = |ui: &mut Ui| fields(ui, id);
            let fields = ui.allocate_ui_with_layout(rest, Layout::right_to_left(Align::Center), fields).inner;
            (label, fields)
        });
        let (label, events) = row.inner;
        if events.changed {
            self.changed_field = Some(name.to_owned());
        }
        self.edit_ended |= events.edit_ended;
        label
    }

    /// Adds a row with one number.
    pub fn number(&mut self, name: &str, tip: &str, value: &mut f32, spec: NumberSpec) {
        self.row(name, tip, |ui, label| number_ui(ui, FieldName::Label(label), tip, value, spec));
    }

    /// Adds a row with a number, or with both ends of a range.
    pub fn ranged(&mut self, name: &str, tip: &str, value: &mut Ranged<f32>, spec: NumberSpec) {
        self.ranged_row(name, tip, value, |ui, name, number| number_ui(ui, name, tip, number, spec));
    }

    /// Adds a row with a whole number, or with both ends of a range.
    pub fn ranged_count(
        &mut self,
        name: &str,
        tip: &str,
        value: &mut Ranged<u32>,
        range: RangeInclusive<u32>,
    ) {
        self.ranged_row(name, tip, value, |ui, name, number| count_ui(ui, name, tip, number, range.clone()));
    }

    /// Adds a row with one `field` for a number, or two for a range. The context menu of the label turns one into the other.
    fn ranged_row<T: RangeNumber>(
        &mut self,
        name: &str,
        tip: &str,
        value: &mut Ranged<T>,
        field: impl Fn(&mut Ui, FieldName, &mut T) -> FieldEvents,
    ) {
        let label = self.row(name, tip, |ui, label| match value {
            Ranged::Number(number) => field(ui, FieldName::Label(label), number),
            Ranged::Range(low, high) => {
                let high = field(ui, FieldName::Text(format!("{name} highest")), high);
                field(ui, FieldName::Text(format!("{name} lowest")), low).or(high)
            }
        });
        let (text, other) = match *value {
            Ranged::Number(number) => ("Draw from a range in every episode", Ranged::Range(number, number)),
            Ranged::Range(..) => ("Same number in every episode", Ranged::Number(value.value())),
        };
        let mut is_chosen = false;
        // Not focusable (unlike `Sense::click`): a label registered twice in the Tab order would keep the focus.
        label.interact(Sense::CLICK).context_menu(|ui| is_chosen = ui.button(text).clicked());
        if is_chosen {
            *value = other;
            self.mark_changed(&format!("{name} range"));
        }
    }

    /// Adds a row with two numbers; each has a name for screen readers.
    pub fn pair(&mut self, name: &str, tip: &str, values: [(&str, &mut f32); 2], spec: NumberSpec) {
        self.row(name, tip, |ui, _| pair_ui(ui, name, tip, values, [spec; 2]));
    }

    /// Adds a row with a position.
    pub fn position(&mut self, name: &str, tip: &str, math::Vec2 { x, y }: &mut math::Vec2) {
        self.pair(name, tip, [("x", x), ("y", y)], NumberSpec::POSITION);
    }

    /// Adds a list with two numbers per entry, and a button to remove each entry while there are more than `min`.
    /// `elsewhere` is shown if there are entries beyond [`MAX_SHOWN`]: a hint on how to edit them.
    pub fn list<T>(
        &mut self,
        name: &str,
        entries: &mut Vec<T>,
        min: usize,
        elsewhere: &str,
        specs: [NumberSpec; 2],
        values: impl for<'t> Fn(&'t mut T) -> [(&'static str, &'t mut f32); 2],
    ) {
        let mut removed = None;
        let count = entries.len();
        for (k, entry) in entries.iter_mut().enumerate().take(MAX_SHOWN) {
            let name = format!("{name} {}", k + 1);
            self.row(&name, "", |ui, _| {
                let events = pair_ui(ui, &name, "", values(entry), specs);
                if count > min && remove_button_ui(ui, &name) {
                    removed = Some(k);
                }
                events
            });
        }
        if let Some(k) = removed {
            entries.remove(k);
            self.mark_changed(&format!("{name} removed"));
        }
        if let Some(more @ 1..) = count.checked_sub(MAX_SHOWN) {
            self.ui.label(weak_text(&format!("and {more} more: {elsewhere}")));
        }
    }

    /// Adds a list of positions.
    pub fn positions(&mut self, name: &str, positions: &mut Vec<math::Vec2>, min: usize) {
        let specs = [NumberSpec::POSITION; 2];
        self.list(name, positions, min, "drag them on the canvas", specs, |math::Vec2 { x, y }| {
            [("x", x), ("y", y)]
        });
    }

    /// Adds a label and, below it, a field for several lines of text in a monospaced font.
    pub fn text(&mut self, name: &str, tip: &str, text: &mut String) {
        let label = with_tip(self.ui.add(Label::new(weak_text(name)).selectable(false)), tip);
        let field = TextEdit::multiline(text).code_editor().lock_focus(false).desired_width(f32::INFINITY);
        let response = self.ui.add(field.desired_rows(3)).labelled_by(label.id);
        if response.changed() {
            self.changed_field = Some(name.to_owned());
        }
        self.edit_ended |= response.lost_focus();
    }

    /// Records a change that is a complete undo step.
    pub fn mark_changed(&mut self, field: &str) {
        (self.changed_field, self.edit_ended) = (Some(field.to_owned()), true);
    }

    /// Adds a row with a whole number.
    pub fn count<T: egui::emath::Numeric>(
        &mut self,
        name: &str,
        tip: &str,
        value: &mut T,
        range: RangeInclusive<T>,
    ) {
        self.row(name, tip, |ui, label| count_ui(ui, FieldName::Label(label), tip, value, range));
    }

    /// Adds a checkbox.
    pub fn checkbox(&mut self, name: &str, tip: &str, value: &mut bool) {
        let palette = Palette::from_ui(self.ui);
        let on = *value;
        let response = self.ui.scope(|ui| {
            let widgets = &mut ui.visuals_mut().widgets;
            for state in [&mut widgets.inactive, &mut widgets.hovered, &mut widgets.active] {
                if on {
                    (state.bg_fill, state.fg_stroke.color) = (palette.accent, palette.on_accent);
                }
            }
            ui.checkbox(value, weak_text(name))
        });
        if with_tip(response.inner, tip).changed() {
            self.mark_changed(name);
        }
    }
}

/// Adds two fields to a row that is filled from the right.
fn pair_ui(
    ui: &mut Ui,
    name: &str,
    tip: &str,
    [(first, a), (second, b)]: [(&str, &mut f32); 2],
    specs: [NumberSpec; 2],
) -> FieldEvents {
    let b = number_ui(ui, FieldName::Text(format!("{name} {second}")), tip, b, specs[1]);
    let a = number_ui(ui, FieldName::Text(format!("{name} {first}")), tip, a, specs[0]);
    a.or(b)
}

/// Shows the button that removes an entry of a list. Returns whether it was clicked.
fn remove_button_ui(ui: &mut Ui, name: &str) -> bool {
    let text = format!("Remove {}", name.to_lowercase());
    icons::icon_button_ui(ui, Icon::Close, ButtonStyle::Quiet, 16.0, &text, &text).clicked()
}
