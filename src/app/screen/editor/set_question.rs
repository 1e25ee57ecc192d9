//! The question in place of the editor while training on a set of scenarios. The set cannot be edited: the question is
//! whether to edit a copy of the scenario that is shown.

use egui::{Key, Rect, RichText, Ui, vec2};

use super::confirm_exit::show_editor;
use crate::app::commands::Command;
use crate::app::editor::Editor;
use crate::app::screen::input::ScreenInput;
use crate::app::screen::theme::{BODY, GAP, Palette};
use crate::app::screen::widgets::buttons::{primary_button_ui, wide_button_ui};
use crate::app::screen::widgets::question::question_ui;
use crate::app::screen::widgets::text::weak_text;
use crate::app::view_state::ViewState;

const WIDTH: f32 = 280.0;
const BUTTON_HEIGHT: f32 = 30.0;

/// Draws the question in the middle of `canvas`, if it is open. Escape cancels.
pub fn set_question_ui(
    ui: &Ui,
    canvas: Rect,
    view: &ScreenInput<'_>,
    view_state: &mut ViewState,
    commands: &mut Vec<Command>,
) {
    let shown = view.scene.arenas.get(view_state.followed);
    let member = shown.and_then(|arena| Some((arena, arena.set_member.as_ref()?)));
    let Some((arena, member)) = member.filter(|_| view_state.interaction.set_question) else {
        view_state.interaction.set_question = false;
        return;
    };
    question_ui(ui, canvas, "edit a scenario of the set", WIDTH, |ui| {
        let text = "A set of scenarios cannot be edited here: change its text file, and open it again.";
        ui.label(RichText::new(text).size(BODY).color(Palette::from_ui(ui).text));
        ui.label(weak_text(
            "A copy of the scenario that is shown can be edited, and saved as a file of its own.",
        ));
        ui.add_space(GAP);
        let copy =
            primary_button_ui(ui, &format!("Edit a copy of {member}"), BODY, vec2(WIDTH, BUTTON_HEIGHT));
        let cancel = wide_button_ui(ui, "Cancel", BUTTON_HEIGHT);
        if copy.clicked() {
            let editor = Editor::with_changes(arena.written.clone(), member.clone(), None);
            show_editor(editor, view.status, view_state, commands);
        }
        if copy.clicked() || cancel.clicked() || ui.input(|input| input.key_pressed(Key::Escape)) {
            view_state.interaction.set_question = false;
        }
    });
}
