//! Into the editor and out of it. What is not saved is asked about.
//!
//! In: the desk, the view. Out: [`Desk::editor`], and orders: time stands still in the editor, and goes on after it if it
//! did before.

use egui::{
    Align2, Area, Button, Context, Frame, Id, Margin, Order as Layer, Rect, RichText, Stroke, Ui, vec2,
};

use super::{half_drawn, panel};
use crate::app::desk::Desk;
use crate::app::editor::Editor;
use crate::app::orders::Order;
use crate::app::screen::View;
use crate::app::screen::theme::{BODY, Inks};

/// What is asked: whether to leave, and what is ordered then.
type Question = Option<Option<Order>>;

const NOT_ASKED: Question = None;

fn running() -> Id {
    Id::new("time went on before the editor")
}

fn question() -> Id {
    Id::new("leave the editor for")
}

/// Opens the editor on the world that runs; where its file was saved since and the new world not taken yet, on that.
pub fn enter(ctx: &Context, view: &View<'_>, desk: &mut Desk, orders: &mut Vec<Order>) {
    let (scene, status) = (view.scene, view.status);
    // Or else the next time it is saved the old world would go over the new one.
    let newer = status.saved_world.as_ref().filter(|(path, world)| {
        status.world_changed && *path == status.scenario_from && *world != scene.scenario
    });
    let (world, saved) = newer.map_or((&scene.scenario, !status.world_changed), |(_, world)| (world, true));
    let editor = Editor::open(world.clone(), status.scenario_from.clone(), saved);
    panel::set_asked(ctx, false);
    desk.editor = Some(Box::new(editor));
    desk.setup_open = true;
    ctx.data_mut(|data| data.insert_temp(running(), !status.paused));
    if !status.paused {
        orders.push(Order::Pause(true));
    }
}

/// Leaves the editor, with an order after it if there is one; asks first if something is not saved.
pub fn ask(ctx: &Context, desk: &mut Desk, then: Option<Order>, orders: &mut Vec<Order>) {
    if desk.editor.as_ref().is_some_and(|editor| editor.is_changed() || half_drawn(editor).is_some()) {
        ctx.data_mut(|data| data.insert_temp(question(), Some(then)));
    } else {
        leave(ctx, desk, then, orders);
    }
}

/// Leaves the editor without asking: nothing is lost, or the user said so.
pub fn leave(ctx: &Context, desk: &mut Desk, then: Option<Order>, orders: &mut Vec<Order>) {
    desk.editor = None;
    panel::set_asked(ctx, false);
    ctx.data_mut(|data| data.insert_temp(question(), NOT_ASKED));
    orders.extend(then);
    if ctx.data_mut(|data| data.remove_temp::<bool>(running())).unwrap_or(false) {
        orders.push(Order::Pause(false));
    }
}

/// The question, in the middle of `world`, if it is asked.
pub fn show(ui: &Ui, world: Rect, desk: &mut Desk, orders: &mut Vec<Order>) {
    let asked = ui.data(|data| data.get_temp::<Question>(question())).flatten();
    let Some((then, editor)) = asked.zip(desk.editor.as_deref()) else { return };
    let words = half_drawn(editor).map_or("The changes of this world are not saved.".into(), |what| {
        format!("The {what} that is being drawn would be lost, and all else that is not saved.")
    });
    let inks = Inks::of(ui);
    let area = Area::new(Id::new("leave the editor")).order(Layer::Foreground).pivot(Align2::CENTER_CENTER);
    area.fixed_pos(world.center()).constrain_to(world).show(ui.ctx(), |ui| {
        let frame = Frame::new()
            .fill(inks.panel)
            .stroke(Stroke::new(1.0, inks.warn))
            .corner_radius(8.0)
            .shadow(ui.visuals().popup_shadow)
            .inner_margin(Margin::same(14));
        frame.show(ui, |ui| {
            ui.set_width(248.0);
            ui.label(RichText::new(words).size(BODY).color(inks.ink));
            ui.horizontal(|ui| {
                let width = (ui.available_width() - ui.spacing().item_spacing.x) / 2.0;
                let size = vec2(width, 28.0);
                if ui.add_sized(size, Button::new("Leave without them")).clicked() {
                    leave(ui.ctx(), desk, then, orders);
                }
                let stay = ui.add_sized(size, Button::new("Go on editing"));
                if stay.clicked() || ui.input(|input| input.key_pressed(egui::Key::Escape)) {
                    ui.data_mut(|data| data.insert_temp(question(), NOT_ASKED));
                }
            });
        });
    });
}

/// Whether the question is asked.
pub fn is_asked(ctx: &Context) -> bool {
    ctx.data(|data| data.get_temp::<Question>(question())).flatten().is_some()
}
