//! The help window: a short explanation, the mouse and the keyboard shortcuts, for the arenas or for the editor.

use egui::{Align2, RichText, Ui, vec2};

use crate::app::screen::editor;
use crate::app::screen::key_bindings::KEY_BINDINGS;
use crate::app::screen::theme::{BODY, GAP};
use crate::app::screen::widgets::text::key_cap_ui;
use crate::app::view_state::ViewState;

const ARENA_HELP: [&str; 5] = [
    "A robot that knows nothing drives in a walled arena. All it perceives are the ranges of its LIDAR beams and the \
     direction and distance of its green goal.",
    "Reaching the goal is rewarded and a collision is punished. From that alone it learns how to drive.",
    "At first most actions are random. As it learns, it relies more on its Q-values, shown as bars next to it: the \
     return it expects from each motion.",
    "The success rate at the top is the share of goals reached in the last evaluation, which has no random actions.",
    "The plots show the progress of training. Test runs the policy alone, Drive lets you race it, and Compare runs it \
     next to another policy.",
];

const EDITOR_HELP: [&str; 3] = [
    "Click an item to select it, drag it to move it, and edit its numbers in the panel.",
    "Errors are orange, with a suggested fix. A scenario with errors cannot be used for training.",
    "Your changes reach the robot only when you continue or restart training in the edited scenario. A saved scenario is \
     a text file that any text editor can open.",
];

const ARENA_MOUSE_HELP: [(&str, &str); 8] = [
    ("Drag", "Move the robot, the goal or an obstacle"),
    ("Drag", "On the floor: pan"),
    ("Scroll", "Zoom"),
    ("Double-click", "On the floor: fit the arena to the view"),
    ("Click", "On the floor, but not in Train: set the goal"),
    ("Click", "In the grid: follow an arena"),
    ("Ctrl+scroll", "On a plot: zoom; drag: pan"),
    ("Drop", "A policy, run, scenario, map or preset: open it"),
];

/// The width of the keys and gestures, in points.
const KEY_WIDTH: f32 = 82.0;

/// The height of the title and the margins of the window, in points.
const AROUND: f32 = 100.0;

/// Draws the help window if it is open. Escape and its close button close it.
pub fn help_ui(ui: &mut Ui, view_state: &mut ViewState) {
    let editing = view_state.editor.is_some();
    let open = &mut view_state.help_open;
    if *open && ui.input(|i| i.key_pressed(egui::Key::Escape)) {
        *open = false;
    }
    egui::Window::new("Help")
        .open(open)
        .collapsible(false)
        .resizable(false)
        .anchor(Align2::CENTER_CENTER, vec2(0.0, 0.0))
        .frame(egui::Frame::window(ui.style()).inner_margin(egui::Margin::same(16)))
        .default_width(620.0)
        .show(ui.ctx(), |ui| {
            let height = (ui.ctx().content_rect().height() - AROUND).max(AROUND);
            // Without a minimum it would shrink to the default height of a window, and hide the shortcuts.
            let scroll = egui::ScrollArea::vertical().max_height(height).min_scrolled_height(height);
            scroll.show(ui, |ui| content_ui(ui, editing));
        });
}

fn content_ui(ui: &mut Ui, editing: bool) {
    ui.spacing_mut().item_spacing.y = GAP;
    for &paragraph in if editing { &EDITOR_HELP[..] } else { &ARENA_HELP } {
        ui.label(paragraph);
    }
    let (mouse, keys): (&[_], Vec<_>) = if editing {
        (&editor::shortcuts::MOUSE_HELP, editor::shortcuts::KEY_HELP.into())
    } else {
        (&ARENA_MOUSE_HELP, KEY_BINDINGS.iter().map(|row| (row.key, row.description)).collect())
    };
    section_ui(ui, "Mouse", mouse);
    section_ui(ui, "Keyboard shortcuts", &keys);
}

/// Draws a table of keys or gestures and their effects, in two columns.
fn section_ui(ui: &mut Ui, title: &str, rows: &[(&str, &str)]) {
    ui.add_space(GAP);
    ui.label(RichText::new(title).size(BODY).strong());
    let half = rows.len().div_ceil(2);
    ui.columns(2, |columns| {
        for (column, rows) in columns.iter_mut().zip(rows.chunks(half)) {
            column.spacing_mut().item_spacing.y = 1.0;
            for (key, description) in rows {
                column.horizontal(|ui| {
                    let start = ui.cursor().left();
                    key_cap_ui(ui, key);
                    ui.add_space((start + KEY_WIDTH - ui.cursor().left()).max(0.0));
                    ui.add(egui::Label::new(*description).wrap());
                });
            }
        }
    });
}
