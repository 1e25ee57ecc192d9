//! One arena with all its overlays, and the pointer over it.

use egui::accesskit::{Rect as AccessRect, Role};
use egui::{Align2, CursorIcon, Id, Rect, Response, Sense, Stroke, Ui, Vec2, WidgetInfo, WidgetType, vec2};

use super::camera::steer_camera;
use super::canvas::Canvas;
use super::field_view::{self, FieldKind};
use super::transform::{ArenaBounds, ViewTransform};
use super::{
    arena, beams, color_bar, drag, drag_target, driver_plan, floor, goal_click, legend, obstacle_paths,
    q_card, silhouette, trajectories,
};
use crate::app::commands::Command;
use crate::app::interaction::ActiveDrag;
use crate::app::moves::Movable;
use crate::app::scene::{ArenaScene, Scene};
use crate::app::screen::input::ScreenInput;
use crate::app::screen::theme::Palette;
use crate::app::view_state::{Overlays, ViewState};
use crate::scenario::Scenario;

/// Space around the walls for the legend and the colour bar, in points.
pub const MARGIN: Vec2 = vec2(18.0, 34.0);

/// Whether the scene has two arenas with different drivers, which are shown side by side.
pub fn is_pair(scene: &Scene) -> bool {
    matches!(&scene.arenas[..], [a, b] if a.driver != b.driver)
}

/// The scenario of arena `index`, without generated obstacles.
pub(super) fn written(scene: &Scene, index: usize) -> &Scenario {
    scene.arenas.get(index).map_or(&scene.scenario, |arena| &arena.written)
}

/// Draws arena `index` in `rect` and handles the pointer over it.
pub fn single_arena(
    ui: &Ui,
    rect: Rect,
    view: &ScreenInput<'_>,
    index: usize,
    view_state: &mut ViewState,
    commands: &mut Vec<Command>,
) -> Canvas {
    let scene = view.scene;
    let id = ui.id().with(("arena view", index));
    // Leave a margin so that the edges of the panels can be dragged from this side too.
    let response = ui.interact(rect.shrink2(vec2(4.0, 0.0)), id, Sense::click_and_drag());
    set_arena_name(&response, index);
    let mut transform = ViewTransform::new(
        rect,
        MARGIN,
        view_state.camera,
        ArenaBounds::from_enclosure(&written(scene, index).enclosure),
    );
    let active =
        drag::update(ui, &response, &transform, view, index, &mut view_state.interaction.drag, commands);
    if response.clicked() || active.is_some() {
        view_state.followed = index;
    }
    let hovered = response.hover_pos().filter(|_| response.contains_pointer());
    let object = match (&active, hovered, scene.arenas.get(index)) {
        (Some(active), _, _) => Some(active.object),
        (None, Some(at), Some(arena)) if !response.dragged() => drag_target::hit_test(&transform, arena, at),
        _ => None,
    };
    steer_camera(ui, &response, &mut transform, &mut view_state.camera, object.is_none());
    let canvas =
        Canvas { painter: ui.painter_at(rect), transform, palette: Palette::from_ui(ui), compact: false };
    if let Some(arena) = scene.arenas.get(index) {
        draw_arena(ui, &canvas, scene, index, arena, view_state, id);
        draw_drag_feedback(ui, &response, &canvas, arena, object, active.as_ref());
        if object.is_none() {
            goal_click::update(ui, &response, &canvas, view, index, commands);
        }
        name_objects(ui, id, &canvas, arena);
    }
    canvas
}

fn draw_arena(
    ui: &Ui,
    canvas: &Canvas,
    scene: &Scene,
    index: usize,
    arena: &ArenaScene,
    view_state: &ViewState,
    id: Id,
) {
    let (scenario, overlays, dark) = (&*arena.written, &view_state.overlays, ui.visuals().dark_mode);
    let followed = index == view_state.followed;
    let value = scene.value.as_deref().filter(|_| followed && overlays.value);
    let potential = scene.potential.as_deref().filter(|_| followed && overlays.potential);
    let field =
        value.map(|field| (FieldKind::Value, field)).or(potential.map(|field| (FieldKind::Potential, field)));
    floor::draw_floor(canvas, &scenario.enclosure);
    if let Some((kind, field)) = field {
        field_view::draw_heatmap(canvas, kind, field, dark);
    }
    if let Some(field) = potential {
        field_view::draw_arrows(canvas, field, canvas.palette.text.gamma_multiply(0.45));
    }
    trajectories::draw(canvas, arena, overlays);
    arena::draw_solids(canvas, &arena.scenario, &arena.obstacles);
    if let Some(plan) = arena.plan.as_ref().filter(|_| overlays.path) {
        driver_plan::draw(canvas, plan);
    }
    arena::draw_goal(canvas, scenario, [arena.goal.x_m, arena.goal.y_m]);
    let beams = overlays.beams && !arena.inactive;
    let label = beams.then(|| beams::draw(canvas, scenario, arena)).flatten();
    arena::draw_robot(canvas, scenario, arena.pose, arena::robot_color(canvas, arena));
    // Of two arenas side by side, only the first has a legend, for both.
    let has_legend = index == 0 || !is_pair(scene);
    let beams =
        overlays.beams && if is_pair(scene) { scene.arenas.iter().any(|a| !a.inactive) } else { beams };
    let downhill = overlays.potential && scene.potential.is_some();
    let shown = Overlays { beams, potential: downhill, ..*overlays };
    let mut occupied: Vec<Rect> = label.into_iter().collect();
    occupied.extend(has_legend.then(|| legend::draw(canvas, &shown)).flatten());
    occupied.extend(field.and_then(|(kind, field)| color_bar::draw(canvas, kind, field, dark)));
    if overlays.q_values && !arena.inactive {
        q_card::draw(canvas, scenario, arena, &occupied, id.with("q side"));
    }
}

/// Highlights the object under the pointer or being dragged; an object that cannot be dropped here is shown
/// in orange with the reason.
fn draw_drag_feedback(
    ui: &Ui,
    response: &Response,
    canvas: &Canvas,
    arena: &ArenaScene,
    object: Option<Movable>,
    active: Option<&ActiveDrag>,
) {
    let (palette, Some(object)) = (&canvas.palette, object) else { return };
    let to_m = active.filter(|drag| drag.rejection.is_some()).map(|drag| drag.to_m);
    let Some(outline) = drag_target::silhouette(arena, object, to_m) else { return };
    if let Movable::Obstacle(obstacle) = object
        && let Some(obstacle) = arena.scenario.obstacles.get(obstacle)
    {
        obstacle_paths::draw(canvas, obstacle, palette.weak_text);
    }
    let around = outline.clone().inflated(4.5 / canvas.transform.scale);
    let clear = egui::Color32::TRANSPARENT;
    match active {
        Some(ActiveDrag { rejection: Some(reason), to_m, .. }) => {
            ui.ctx().set_cursor_icon(CursorIcon::NoDrop);
            silhouette::draw(
                canvas,
                &outline,
                palette.error.gamma_multiply(0.35),
                Stroke::new(2.0, palette.error),
            );
            let below = vec2(0.0, canvas.transform.to_screen_length(outline.reach_m()) + 7.0);
            canvas.label(
                canvas.to_screen(*to_m) + below,
                Align2::CENTER_TOP,
                &reason.to_string(),
                palette.error,
            );
        }
        Some(_) => {
            ui.ctx().set_cursor_icon(CursorIcon::Grabbing);
            silhouette::draw(canvas, &around, clear, Stroke::new(2.0, palette.text));
        }
        None => {
            ui.ctx().set_cursor_icon(CursorIcon::Grab);
            silhouette::draw(canvas, &around, clear, Stroke::new(1.5, palette.text.gamma_multiply(0.8)));
            response.clone().on_hover_text_at_pointer(drag::tooltip(object));
        }
    }
}

/// Adds the draggable objects to the accessibility tree, if egui builds one.
fn name_objects(ui: &Ui, view: Id, canvas: &Canvas, arena: &ArenaScene) {
    let movable = if arena.set_member.is_some() { 0 } else { arena.written.obstacles.len() };
    let obstacles = (0..movable).map(Movable::Obstacle);
    for object in [Movable::Robot, Movable::Goal].into_iter().chain(obstacles) {
        name_object(ui, view.with(object), || {
            let outline = drag_target::silhouette(arena, object, None)?;
            Some((object.to_string(), outline.screen_rect(canvas)))
        });
    }
}

/// Adds a draggable object to the accessibility tree. `describe` returns its name and its rectangle on the screen; it is
/// called only if egui builds a tree.
pub fn name_object(ui: &Ui, id: Id, describe: impl FnOnce() -> Option<(String, Rect)>) {
    ui.ctx().accesskit_node_builder(id, |node| {
        let Some((name, rect)) = describe() else { return };
        node.set_role(Role::GraphicsObject);
        node.set_label(name);
        node.set_bounds(AccessRect::new(
            rect.min.x.into(),
            rect.min.y.into(),
            rect.max.x.into(),
            rect.max.y.into(),
        ));
    });
}

/// Names the view of an arena for screen readers and tests.
pub fn set_arena_name(response: &Response, index: usize) {
    let name = format!("Arena {}", index + 1);
    response.widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, &name));
}
