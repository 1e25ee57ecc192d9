//! The top of the editor's panel: the scenario's name and file, undo and redo, new and open.

use std::path::{Path, PathBuf};

use egui::{Align, Button, Label, Layout, RichText, ScrollArea, TextEdit, Ui, vec2};

use super::actions::Action;
use super::controls::set_accessible_name;
use crate::app::commands::Command;
use crate::app::editor::Editor;
use crate::app::screen::input::ScreenInput;
use crate::app::screen::theme::SMALL;
use crate::app::screen::widgets::icons::{self, ButtonStyle, Icon};
use crate::app::screen::widgets::text::weak_text;
use crate::scenario::limits::MAX_NAME_CHARS;

/// Shows the name, the file, undo, redo and close.
pub fn header_ui(ui: &mut Ui, editor: &mut Editor) -> Option<Action> {
    let mut action = None;
    right_to_left_ui(ui, |ui| {
        let tip = "Back to the running scenario";
        if icons::icon_button_ui(ui, Icon::Close, ButtonStyle::Quiet, 22.0, "Close the editor", tip).clicked()
        {
            action = Some(Action::Close);
        }
        name_ui(ui, editor);
    });
    right_to_left_ui(ui, |ui| {
        ui.spacing_mut().button_padding = vec2(6.0, 2.0);
        undo_redo_ui(ui, editor);
        file_ui(ui, editor);
    });
    action
}

/// A row that is filled from the right.
fn right_to_left_ui(ui: &mut Ui, fill: impl FnOnce(&mut Ui)) {
    ui.horizontal(|ui| ui.with_layout(Layout::right_to_left(Align::Center), fill));
}

fn undo_redo_ui(ui: &mut Ui, editor: &mut Editor) {
    let small = |ui: &mut Ui, enabled, text, tip| {
        let button = ui.add_enabled(enabled, Button::new(RichText::new(text).size(SMALL)));
        button.on_hover_text(tip).on_disabled_hover_text(tip).clicked()
    };
    if small(ui, editor.can_redo(), "Redo", "Redo the last undone change  (Ctrl+Y)") {
        editor.redo();
    }
    if small(ui, editor.can_undo(), "Undo", "Undo the last change  (Ctrl+Z)") {
        editor.undo();
    }
}

/// The short name of the file, and whether there are unsaved changes.
fn file_ui(ui: &mut Ui, editor: &Editor) {
    let from = Path::new(editor.from());
    let short = from.file_name().map_or(editor.from().into(), |name| name.to_string_lossy());
    let modified = if editor.is_modified() { " · modified" } else { "" };
    let text = weak_text(&format!("{short}{modified}"));
    ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
        ui.add(Label::new(text).truncate()).on_hover_text(editor.from());
    });
}

fn name_ui(ui: &mut Ui, editor: &mut Editor) {
    let mut name = editor.scenario().name.clone();
    let field = TextEdit::singleline(&mut name).char_limit(MAX_NAME_CHARS).hint_text("Name");
    let size = vec2(ui.available_width(), 26.0);
    let response = ui.add_sized(size, field.vertical_align(Align::Center));
    set_accessible_name(&response, "Scenario name");
    if response.changed() {
        editor.edit("name", |scenario| scenario.name = name);
    }
    if response.lost_focus() {
        editor.close_group();
    }
}

/// Shows the buttons that open another scenario: a built-in one as a template, or a file.
pub fn open_ui(ui: &mut Ui, input: &ScreenInput<'_>, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        let width = (ui.available_width() - ui.spacing().item_spacing.x) / 2.0;
        let new = ui.add_sized(vec2(width, 26.0), Button::new("New from…"));
        let new = new.on_hover_text("Start from a built-in scenario");
        egui::Popup::menu(&new).show(|ui| templates_ui(ui, input, commands));
        let open = ui.add_sized(vec2(width, 26.0), Button::new("Open…"));
        if open.on_hover_text("Open a scenario file  (Ctrl+O)").clicked() {
            commands.push(Command::OpenInEditor(None));
        }
    });
}

/// The built-in scenarios: those without a file extension. The editor cannot open the user's maps and Gazebo worlds.
fn templates_ui(ui: &mut Ui, input: &ScreenInput<'_>, commands: &mut Vec<Command>) {
    let is_file = |from: &str| Path::new(from).extension().is_some();
    ScrollArea::vertical().max_height(320.0).show(ui, |ui| {
        for choice in input.status.scenarios.iter().filter(|choice| !is_file(&choice.from)) {
            if ui.button(&choice.title).on_hover_text(&choice.about).clicked() {
                commands.push(Command::OpenInEditor(Some(PathBuf::from(&choice.from))));
                ui.close();
            }
        }
    });
}
