//! Into the editor and out of it. What is not saved is asked about.
//!
//! In: the desk, the view. Out: [`ViewState::editor`], and orders: time stands still in the editor, and goes on after it if it
//! did before.

use egui::{
    Align2, Area, Button, Context, Frame, Id, Margin, Order as Layer, Rect, RichText, Stroke, Ui, vec2,
};

use super::{panel, unfinished_drawing};
use crate::app::commands::Command;
use crate::app::editor::Editor;
use crate::app::screen::input::ScreenInput;
use crate::app::screen::theme::{BODY, Palette};
use crate::app::view_state::ViewState;

/// What is asked: whether to leave, and what is ordered then.
type Confirm = Option<Option<Command>>;

const NOT_ASKED: Confirm = None;

fn was_running_id() -> Id {
    Id::new("time went on before the editor")
}

fn confirm_id() -> Id {
    Id::new("leave the editor for")
}

/// Opens the editor on the world that runs; where its file was saved since and the new world not taken yet, on that.
pub fn enter_editor(
    ctx: &Context,
    view: &ScreenInput<'_>,
    view_state: &mut ViewState,
    commands: &mut Vec<Command>,
) {
    let (scene, status) = (view.scene, view.status);
    // Or else the next time it is saved the old world would go over the new one.
    let newer = status.saved_scenario.as_ref().filter(|(path, world)| {
        status.scenario_modified && *path == status.scenario_from && *world != scene.scenario
    });
    let (world, saved) =
        newer.map_or((&scene.scenario, !status.scenario_modified), |(_, world)| (world, true));
    let editor = Editor::open(world.clone(), status.scenario_from.clone(), saved);
    panel::set_confirm_restart(ctx, false);
    view_state.editor = Some(Box::new(editor));
    view_state.setup_open = true;
    ctx.data_mut(|data| data.insert_temp(was_running_id(), !status.paused));
    if !status.paused {
        commands.push(Command::Pause(true));
    }
}

/// Leaves the editor, with an order after it if there is one; asks first if something is not saved.
pub fn request_exit(
    ctx: &Context,
    view_state: &mut ViewState,
    then: Option<Command>,
    commands: &mut Vec<Command>,
) {
    if view_state
        .editor
        .as_ref()
        .is_some_and(|editor| editor.is_modified() || unfinished_drawing(editor).is_some())
    {
        ctx.data_mut(|data| data.insert_temp(confirm_id(), Some(then)));
    } else {
        exit_editor(ctx, view_state, then, commands);
    }
}

/// Leaves the editor without asking: nothing is lost, or the user said so.
pub fn exit_editor(
    ctx: &Context,
    view_state: &mut ViewState,
    then: Option<Command>,
    commands: &mut Vec<Command>,
) {
    view_state.editor = None;
    panel::set_confirm_restart(ctx, false);
    ctx.data_mut(|data| data.insert_temp(confirm_id(), NOT_ASKED));
    commands.extend(then);
    if ctx.data_mut(|data| data.remove_temp::<bool>(was_running_id())).unwrap_or(false) {
        commands.push(Command::Pause(false));
    }
}

/// The question, in the middle of `world`, if it is asked.
pub fn confirm_exit_ui(ui: &Ui, world: Rect, view_state: &mut ViewState, commands: &mut Vec<Command>) {
    let asked = ui.data(|data| data.get_temp::<Confirm>(confirm_id())).flatten();
    let Some((then, editor)) = asked.zip(view_state.editor.as_deref()) else { return };
    let words = unfinished_drawing(editor)
        .map_or("The changes of this world are not saved.".into(), |what| {
            format!("The {what} that is being drawn would be lost, and all else that is not saved.")
        });
    let palette = Palette::from_ui(ui);
    let area = Area::new(Id::new("leave the editor")).order(Layer::Foreground).pivot(Align2::CENTER_CENTER);
    area.fixed_pos(world.center()).constrain_to(world).show(ui.ctx(), |ui| {
        let frame = Frame::new()
            .fill(palette.panel)
            .stroke(Stroke::new(1.0, palette.warning))
            .corner_radius(8.0)
            .shadow(ui.visuals().popup_shadow)
            .inner_margin(Margin::same(14));
        frame.show(ui, |ui| {
            ui.set_width(248.0);
            ui.label(RichText::new(words).size(BODY).color(palette.text));
            ui.horizontal(|ui| {
                let width = (ui.available_width() - ui.spacing().item_spacing.x) / 2.0;
                let size = vec2(width, 28.0);
                if ui.add_sized(size, Button::new("Leave without them")).clicked() {
                    exit_editor(ui.ctx(), view_state, then, commands);
                }
                let stay = ui.add_sized(size, Button::new("Go on editing"));
                if stay.clicked() || ui.input(|input| input.key_pressed(egui::Key::Escape)) {
                    ui.data_mut(|data| data.insert_temp(confirm_id(), NOT_ASKED));
                }
            });
        });
    });
}

/// Whether the question is asked.
pub fn is_open(ctx: &Context) -> bool {
    ctx.data(|data| data.get_temp::<Confirm>(confirm_id())).flatten().is_some()
}
