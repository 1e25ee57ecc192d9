//! The editor's panel, in place of the setup: the world's name, what can be added, the numbers of what is selected,
//! what is wrong, and what becomes of it all.
//!
//! In: the view, the editor on the desk. Out: the editor's changes, and orders. What would give up a training of some
//! worth is asked about first.

use std::path::{Path, PathBuf};

use bevy::math;
use egui::{
    Align, Button, Context, Frame, Id, Label, Layout, Margin, Panel, RichText, ScrollArea, Stroke, TextEdit,
    Ui, Vec2, vec2,
};

use super::fields::{button_row_ui, choice_ui, set_accessible_name};
use super::{confirm_exit, diagnostics, finish_drawing, inspector, unfinished_drawing, view_center_m};
use crate::app::commands::Command;
use crate::app::editor::{Editor, NewItem, Snap, Tool, format_metres};
use crate::app::screen::input::ScreenInput;
use crate::app::screen::numbers;
use crate::app::screen::theme::{BODY, GAP, Palette, SMALL};
use crate::app::screen::widgets::buttons;
use crate::app::screen::widgets::icons::{self, ButtonStyle, Icon};
use crate::app::screen::widgets::text::{section_title_ui, weak_text};
use crate::app::view_state::{ViewCamera, ViewState};

/// The height of the wide buttons.
const TALL: f32 = 30.0;
/// A panel as high as this keeps what is wrong and what becomes of it in sight.
const ROOMY: f32 = 560.0;

/// What is asked for at the panel's foot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Wish {
    GoOn,
    Again,
    Close,
}

/// Draws it.
pub fn panel_ui(
    ui: &mut Ui,
    view: &ScreenInput<'_>,
    view_state: &mut ViewState,
    commands: &mut Vec<Command>,
) {
    let camera = view_state.camera;
    let Some(editor) = view_state.editor.as_deref_mut() else { return };
    let inner = Frame::new().inner_margin(Margin::symmetric(14, 12));
    let mut wish = None;
    let roomy = ui.available_height() >= ROOMY;
    if roomy {
        let foot = Panel::bottom("editor foot").resizable(false).frame(inner);
        foot.show(ui, |ui| {
            // What is wrong may be much: it has its own scroll bar, in the margin.
            let most = ui.ctx().content_rect().height() * 0.16;
            let list = ScrollArea::vertical().id_salt("findings").max_height(most);
            list.show(ui, |ui| diagnostics::diagnostics_ui(ui, editor));
            wish = actions_ui(ui, view, editor, commands);
        });
    }
    ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        inner.show(ui, |ui| {
            wish = header_ui(ui, editor).or(wish);
            templates_ui(ui, view, commands);
            separator_ui(ui);
            add_ui(ui, editor, camera);
            separator_ui(ui);
            inspector::inspector_ui(ui, editor);
            if !roomy {
                separator_ui(ui);
                diagnostics::diagnostics_ui(ui, editor);
                wish = actions_ui(ui, view, editor, commands).or(wish);
            }
        });
    });
    if wish.is_some() {
        set_confirm_restart(ui.ctx(), false);
    }
    if matches!(wish, Some(Wish::GoOn | Wish::Again)) {
        finish_drawing(editor);
    }
    // What was drawn may be in the way, or nothing yet.
    wish = wish.filter(|wish| match wish {
        Wish::GoOn => why_not_go_on(view, editor).is_none(),
        Wish::Again => why_not_again(editor).is_none(),
        Wish::Close => true,
    });
    let (scenario, from) = (editor.scenario().clone(), editor.from().to_owned());
    match wish {
        Some(Wish::Close) => confirm_exit::request_exit(ui.ctx(), view_state, None, commands),
        Some(wish) => {
            let taken = Command::ApplyScenario { scenario, from, restart: wish == Wish::Again };
            confirm_exit::exit_editor(ui.ctx(), view_state, Some(taken), commands);
        }
        None => {}
    }
}

/// Its name, where it came from, the way back.
fn header_ui(ui: &mut Ui, editor: &mut Editor) -> Option<Wish> {
    let mut wish = None;
    right_to_left_ui(ui, |ui| {
        let tip = "Back to the world that runs";
        if icons::icon_button_ui(ui, Icon::Close, ButtonStyle::Quiet, 22.0, "Close the editor", tip).clicked()
        {
            wish = Some(Wish::Close);
        }
        name_ui(ui, editor);
    });
    right_to_left_ui(ui, |ui| {
        ui.spacing_mut().button_padding = vec2(6.0, 2.0);
        let undo = "The last change is taken back  (Ctrl+Z)";
        let redo = "It is made again  (Ctrl+Y)";
        let small = |ui: &mut Ui, can, text, tip| {
            let button = ui.add_enabled(can, Button::new(RichText::new(text).size(SMALL)));
            button.on_hover_text(tip).on_disabled_hover_text(tip).clicked()
        };
        if small(ui, editor.can_redo(), "Redo", redo) {
            editor.redo();
        }
        if small(ui, editor.can_undo(), "Undo", undo) {
            editor.undo();
        }
        let from = Path::new(editor.from());
        let short = from.file_name().map_or(editor.from().into(), |name| name.to_string_lossy());
        let changed = if editor.is_modified() { " · changed" } else { "" };
        let text = weak_text(&format!("{short}{changed}"));
        ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
            ui.add(Label::new(text).truncate()).on_hover_text(editor.from());
        });
    });
    wish
}

/// A row that is filled from the right.
fn right_to_left_ui(ui: &mut Ui, fill: impl FnOnce(&mut Ui)) {
    ui.horizontal(|ui| ui.with_layout(Layout::right_to_left(Align::Center), fill));
}

fn name_ui(ui: &mut Ui, editor: &mut Editor) {
    let mut name = editor.scenario().name.clone();
    let field = TextEdit::singleline(&mut name).char_limit(100).hint_text("Name");
    let size = vec2(ui.available_width(), 26.0);
    let response = ui.add_sized(size, field.vertical_align(Align::Center));
    set_accessible_name(&response, "Name of the world");
    if response.changed() {
        editor.edit("name", |scenario| scenario.name = name);
    }
    if response.lost_focus() {
        editor.close_group();
    }
}

/// Worlds to begin with.
fn templates_ui(ui: &mut Ui, view: &ScreenInput<'_>, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        let width = (ui.available_width() - ui.spacing().item_spacing.x) / 2.0;
        let own = |from: &str| Path::new(from).extension() == Some("ron".as_ref());
        let new = ui.add_sized(vec2(width, 26.0), Button::new("New from…"));
        let new = new.on_hover_text("A world that comes with the program, to be made into another");
        egui::Popup::menu(&new).show(|ui| {
            ScrollArea::vertical().max_height(320.0).show(ui, |ui| {
                for choice in view.status.scenarios.iter().filter(|choice| !own(&choice.from)) {
                    if ui.button(&choice.title).on_hover_text(&choice.about).clicked() {
                        commands.push(Command::OpenInEditor(Some(PathBuf::from(&choice.from))));
                        ui.close();
                    }
                }
            });
        });
        let open = ui.add_sized(vec2(width, 26.0), Button::new("Open…"));
        if open.on_hover_text("A world from a file  (Ctrl+O)").clicked() {
            commands.push(Command::OpenInEditor(None));
        }
    });
}

/// What can be added: it stands near the middle of what is seen.
fn add_ui(ui: &mut Ui, editor: &mut Editor, camera: ViewCamera) {
    section_title_ui(ui, "Add");
    let near: math::Vec2 = view_center_m(ui, editor, camera);
    let forms = [
        (NewItem::Circle, "Circle", "Add a circle"),
        (NewItem::Box, "Box", "Add a box"),
        (NewItem::Capsule, "Rod", "Add a rod with round ends"),
        (NewItem::Triangle, "Triangle", "Add a polygon of three corners"),
        (NewItem::Hexagon, "Hexagon", "Add a polygon of six corners"),
    ];
    let gap = ui.spacing().item_spacing.x;
    let size = vec2((ui.available_width() - 2.0 * gap) / 3.0, 26.0);
    for row in forms.chunks(3) {
        ui.horizontal(|ui| {
            ui.spacing_mut().button_padding.x = 2.0;
            for &(form, text, name) in row {
                let button = ui.add_sized(size, Button::new(text)).on_hover_text(name);
                set_accessible_name(&button, name);
                if button.clicked() {
                    editor.add(form, near);
                }
            }
            if row.len() < 3 {
                wall_button_ui(ui, editor, size);
            }
        });
    }
    let name = "Add obstacles that are drawn anew for every episode";
    let button = ui.add_sized(vec2(ui.available_width(), 26.0), Button::new("Random obstacles"));
    set_accessible_name(&button, name);
    if button.on_hover_text(name).clicked() {
        editor.add(NewItem::Generator, near);
    }
    grid_choice_ui(ui, editor);
}

/// The button that begins and ends a wall.
fn wall_button_ui(ui: &mut Ui, editor: &mut Editor, size: Vec2) {
    let drawing = matches!(editor.tool(), Tool::Wall { .. });
    let (text, name) = if drawing { ("Done", "The wall is done") } else { ("Wall", "Draw a wall") };
    let tip = "Click its corners in the world; a double click or Enter ends it";
    let button = ui.add_sized(size, Button::new(text).selected(drawing)).on_hover_text(tip);
    set_accessible_name(&button, name);
    if button.clicked() {
        if drawing {
            editor.finish_tool();
        } else {
            editor.set_tool(Tool::Wall { corners_m: Vec::new() });
        }
    }
}

fn grid_choice_ui(ui: &mut Ui, editor: &mut Editor) {
    let now = editor.snap.on.then_some(editor.snap.step_m);
    let texts = Snap::STEPS_M.map(|step_m| (Some(step_m), format!("{} m", format_metres(step_m))));
    let about = "What is dragged goes to a grid of so much, and turns by 15°; with Alt it is free";
    let mut all: Vec<(Option<f32>, &str, &str)> = vec![(None, "Off", "What is dragged goes where it is put")];
    all.extend(texts.iter().map(|(step, text)| (*step, text.as_str(), about)));
    if let Some(chosen) = choice_ui(ui, "Grid", now, &all) {
        editor.snap = Snap { on: chosen.is_some(), step_m: chosen.unwrap_or(editor.snap.step_m) };
    }
}

/// What becomes of it: driven in, saved.
fn actions_ui(
    ui: &mut Ui,
    view: &ScreenInput<'_>,
    editor: &mut Editor,
    commands: &mut Vec<Command>,
) -> Option<Wish> {
    ui.add_space(GAP);
    let (go_on, again) = (why_not_go_on(view, editor), why_not_again(editor));
    let asks = is_confirming_restart(ui.ctx()) && again.is_none();
    set_confirm_restart(ui.ctx(), asks);
    // Over the buttons, which rest meanwhile: a double click on one of them answers nothing.
    let mut wish = if asks { confirm_restart_ui(ui, view) } else { None };
    let size = vec2((ui.available_width() - ui.spacing().item_spacing.x) / 2.0, TALL);
    ui.horizontal(|ui| {
        ui.spacing_mut().button_padding.x = 2.0;
        let text = "Go on here";
        let button = if asks || go_on.is_some() {
            ui.add_enabled_ui(false, |ui| ui.add_sized(size, Button::new(text))).inner
        } else {
            buttons::primary_button_ui(ui, text, BODY, size)
        };
        let about = "The policy goes on learning in this world";
        let why = go_on.as_deref().unwrap_or(about);
        if button.on_hover_text(about).on_disabled_hover_text(why).clicked() {
            wish = Some(Wish::GoOn);
        }
        let begins = Button::new("Start again here");
        let begins = ui.add_enabled_ui(again.is_none() && !asks, |ui| ui.add_sized(size, begins)).inner;
        let about = "A new training from nothing in this world; what was learnt is given up";
        let begins = begins.on_hover_text(about).on_disabled_hover_text(again.unwrap_or(about));
        if begins.clicked() && view.status.restart_loses_training {
            finish_drawing(editor);
            set_confirm_restart(ui.ctx(), true);
        } else if begins.clicked() {
            wish = Some(Wish::Again);
        }
    });
    if let Some(why) = &go_on {
        ui.label(weak_text(why));
    }
    files_ui(ui, view, editor, commands);
    wish
}

/// Why the policy cannot go on in this world.
fn why_not_go_on(view: &ScreenInput<'_>, editor: &Editor) -> Option<String> {
    if let Some(why) = why_not_again(editor) {
        return Some(why.into());
    }
    let (here, there) = (&**editor.scenario(), &*view.scene.scenario);
    let shape = |s: &crate::scenario::Scenario| (s.lidar.beams, s.robot.motions.len());
    if shape(here) != shape(there) {
        let (beams, motions) = shape(there);
        return Some(format!(
            "The network was made for {beams} beams and {motions} motions: start again to learn with others."
        ));
    }
    (here == there && unfinished_drawing(editor).is_none()).then(|| "This is the world that runs.".into())
}

/// Why no training can begin in this world.
fn why_not_again(editor: &Editor) -> Option<&'static str> {
    (!editor.diagnostics().is_empty()).then_some("First mend what is wrong.")
}

fn files_ui(ui: &mut Ui, view: &ScreenInput<'_>, editor: &mut Editor, commands: &mut Vec<Command>) {
    let all = [
        ("Save", "As a RON file, which any text editor opens; its comments are kept  (Ctrl+S)", true),
        ("Save as…", "Under another name", true),
    ];
    let Some(pressed) = button_row_ui(ui, &all) else { return };
    finish_drawing(editor);
    commands.push(Command::SaveScenario {
        scenario: editor.scenario().clone(),
        based_on: editor.from().to_owned(),
        path: editor.file().filter(|_| pressed == 0 && view.status.has_disk),
    });
}

fn asked() -> Id {
    Id::new("start again in the edited world")
}

fn is_confirming_restart(ctx: &Context) -> bool {
    ctx.data(|data| data.get_temp(asked())).unwrap_or(false)
}

/// Asks whether the present training may be given up, or asks no more.
pub(super) fn set_confirm_restart(ctx: &Context, asks: bool) {
    ctx.data_mut(|data| data.insert_temp(asked(), asks));
}

/// The question whether the present training may be given up.
fn confirm_restart_ui(ui: &mut Ui, view: &ScreenInput<'_>) -> Option<Wish> {
    let palette = Palette::from_ui(ui);
    let frame = Frame::new()
        .stroke(Stroke::new(1.0, palette.warning))
        .corner_radius(5.0)
        .inner_margin(Margin::same(8));
    let pressed = frame.show(ui, |ui| {
        ui.set_width(ui.available_width());
        let episodes = if view.status.episodes == 1 { "episode" } else { "episodes" };
        let text = format!(
            "This training of {} {episodes} will be gone.",
            numbers::format_count(view.status.episodes)
        );
        ui.label(RichText::new(text).color(palette.text));
        button_row_ui(
            ui,
            &[("Start again", "A new training begins", true), ("Keep it", "All stays as it is", true)],
        )
    });
    let pressed = pressed.inner?;
    set_confirm_restart(ui.ctx(), false);
    (pressed == 0).then_some(Wish::Again)
}

fn separator_ui(ui: &mut Ui) {
    ui.add_space(GAP);
    ui.separator();
    ui.add_space(GAP * 0.5);
}
