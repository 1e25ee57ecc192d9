//! The help window: what one sees, in five sentences, and the keys.
//!
//! In: whether it is open, and whether a world is edited. Out: nothing else.

use egui::{Align2, RichText, Ui, vec2};

use crate::app::screen::editor;
use crate::app::screen::key_bindings::KEY_BINDINGS;
use crate::app::screen::theme::{BODY, GAP};
use crate::app::screen::widgets::text::key_cap_ui;
use crate::app::view_state::ViewState;

const SENTENCES: [&str; 5] = [
    "A robot that knows nothing drives in a walled world, and all it sees of it are the ranges of its LIDAR's beams \
     and where its green goal lies.",
    "Reaching the goal is rewarded and a collision punished; from that alone it learns what to do where.",
    "At first it mostly tries things at random; the more it has learnt, the more it trusts its Q-values, the bars \
     beside it: what it expects of each of its motions.",
    "The success rate at the top tells how often it reached the goal in the last test, where nothing is left to \
     chance.",
    "The curves show how learning went, and with Test, Drive and Compare you watch the policy alone, race \
     against it, or set it against another.",
];

/// The same of the editor.
const EDITING: [&str; 3] = [
    "Here the world is a drawing: what you click is selected, what you drag moves, and the panel has its numbers.",
    "What can't be meant is shown in orange, with what is wrong and how to mend it; such a world can't be driven in.",
    "Nothing changes for the robot until you take the world over: then the policy goes on in it, or a training begins \
     there from nothing. Saved as a file, it can be opened in any text editor, too.",
];

/// Draws it if it is open, and takes note when it is closed.
pub fn help_ui(ui: &mut Ui, view_state: &mut ViewState) {
    let editing = view_state.editor.is_some();
    let rows: Vec<(&str, &str)> = if editing {
        editor::shortcuts::KEY_HELP.into()
    } else {
        KEY_BINDINGS.iter().map(|row| (row.key, row.description)).collect()
    };
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
            ui.spacing_mut().item_spacing.y = GAP;
            ui.add_space(GAP);
            for &sentence in if editing { &EDITING[..] } else { &SENTENCES } {
                ui.label(sentence);
            }
            ui.add_space(2.0 * GAP);
            ui.label(RichText::new("Keys").size(BODY).strong());
            let half = rows.len().div_ceil(2);
            ui.columns(2, |columns| {
                for (column, rows) in columns.iter_mut().zip(rows.chunks(half)) {
                    for (key, what) in rows {
                        column.horizontal(|ui| {
                            let width = 58.0;
                            let start = ui.cursor().left();
                            key_cap_ui(ui, key);
                            ui.add_space((start + width - ui.cursor().left()).max(0.0));
                            ui.add(egui::Label::new(*what).wrap());
                        });
                    }
                }
            });
        });
}
