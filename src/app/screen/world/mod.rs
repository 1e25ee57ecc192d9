//! The world view: one arena large, all as a grid, or two side by side; with the camera and the hand on the world.
//!
//! In: the [`ScreenInput`]. Out: the picture, changes of the [`ViewState`] (camera, which arena is followed), and the orders of what
//! is dragged.
//!
//! | file | duty |
//! |---|---|
//! | `transform.rs` | metres to points and back, and the camera |
//! | `canvas.rs` | what is drawn with: ribbons, chips, cards |
//! | `arena.rs` | floor, walls, obstacles, goal, robot, ways |
//! | `silhouette.rs`, `polygon.rs` | the shapes of things; the floor, wherever its corners point |
//! | `obstacle_paths.rs` | where moving obstacles go |
//! | `beams.rs` | the LIDAR's beams |
//! | `q_bars.rs` | the Q-values beside the robot |
//! | `field_view.rs`, `field_image.rs` | the potential and the value over the plane; their colours |
//! | `legend.rs` | what the marks mean |
//! | `arena_grid.rs` | all arenas as a grid |
//! | `score.rs` | who drives, and how well so far |
//! | `drag.rs` | what the pointer takes hold of and drags |
//! | `steer.rs` | the arrow keys in Drive mode |
//! | `welcome.rs` | the call to a first-time user |

pub mod arena;
mod arena_grid;
mod beams;
pub mod canvas;
mod drag;
mod field_image;
mod field_view;
mod legend;
pub mod obstacle_paths;
pub mod polygon;
mod q_bars;
mod score;
pub mod silhouette;
pub mod steer;
pub mod transform;
pub mod welcome;

use egui::{Align2, CursorIcon, FontId, Id, Rect, Response, Sense, Stroke, Ui, Vec2, vec2};

use self::canvas::Canvas;
use self::drag::ActiveDrag;
use self::field_view::FieldKind;
use self::transform::{ArenaBounds, ViewTransform};
use crate::app::commands::Command;
use crate::app::moves::Movable;
use crate::app::scene::{ArenaScene, DriverLabel, Scene};
use crate::app::screen::ScreenInput;
use crate::app::screen::theme::{Palette, SMALL};
use crate::app::view_state::{Overlays, ViewCamera, ViewState};

/// Space around the walls in a large view, where the legend and the key to a field are.
const MARGIN: Vec2 = vec2(18.0, 34.0);

/// Fills what is left of `ui` with the world.
pub fn arenas_ui(
    ui: &mut Ui,
    view: &ScreenInput<'_>,
    view_state: &mut ViewState,
    commands: &mut Vec<Command>,
) {
    let scene = view.scene;
    let rect = ui.available_rect_before_wrap();
    ui.advance_cursor_after_rect(rect);
    if !rect.is_positive() || scene.arenas.is_empty() {
        return;
    }
    ui.painter_at(rect).rect_filled(rect, 0.0, Palette::from_ui(ui).background);
    view_state.followed = view_state.followed.min(scene.arenas.len() - 1);
    if is_pair(scene) {
        pair_ui(ui, rect, view, view_state, commands);
    } else if is_alone(scene) {
        headed(ui, rect, view, 0, view_state, commands);
    } else if view_state.grid && scene.arenas.len() > 1 {
        arena_grid::arena_grid_ui(ui, rect, scene, view_state);
    } else {
        let index = view_state.followed;
        let canvas = large(ui, rect, view, index, view_state, commands);
        if scene.arenas.len() > 1 {
            let words = format!("Arena {} of {}", index + 1, scene.arenas.len());
            let at = rect.min + vec2(14.0, 16.0);
            let font = FontId::proportional(SMALL);
            let galley = canvas.painter.layout_no_wrap(words, font, canvas.palette.weak_text);
            let corner = at - vec2(0.0, galley.size().y / 2.0);
            canvas.strip_background(Rect::from_min_size(corner, galley.size()).expand2(vec2(6.0, 3.0)));
            canvas.painter.galley(corner, galley, canvas.palette.weak_text);
        }
    }
}

/// Two arenas that are driven by different drivers are always seen side by side.
fn is_pair(scene: &Scene) -> bool {
    matches!(&scene.arenas[..], [a, b] if a.driver != b.driver)
}

/// One arena that a policy drives alone.
fn is_alone(scene: &Scene) -> bool {
    matches!(&scene.arenas[..], [only] if matches!(only.driver, DriverLabel::Policy(_)))
}

fn pair_ui(
    ui: &mut Ui,
    rect: Rect,
    view: &ScreenInput<'_>,
    view_state: &mut ViewState,
    commands: &mut Vec<Command>,
) {
    let line = Stroke::new(1.0, Palette::from_ui(ui).border);
    let (first, second) = if rect.width() >= rect.height() * 0.9 {
        ui.painter_at(rect).vline(rect.center().x, rect.y_range(), line);
        rect.split_left_right_at_fraction(0.5)
    } else {
        ui.painter_at(rect).hline(rect.x_range(), rect.center().y, line);
        rect.split_top_bottom_at_fraction(0.5)
    };
    for (index, part) in [first, second].into_iter().enumerate() {
        headed(ui, part, view, index, view_state, commands);
    }
}

/// One arena, under a header that says who drives there and how well.
fn headed(
    ui: &Ui,
    part: Rect,
    view: &ScreenInput<'_>,
    index: usize,
    view_state: &mut ViewState,
    commands: &mut Vec<Command>,
) {
    let (header, below) = part.split_top_bottom_at_y(part.top() + score::HEIGHT);
    let below = below.shrink2(vec2(1.0, 0.0));
    large(ui, below, view, index, view_state, commands);
    if let Some(arena) = view.scene.arenas.get(index) {
        // As wide as the arena is when it fits.
        let bounds = ArenaBounds::from_enclosure(&view.scene.scenario.enclosure);
        let fit = ViewTransform::new(below, MARGIN, ViewCamera::default(), bounds);
        score::draw(ui, header, fit.bounds_rect().width(), arena);
    }
}

/// One arena with everything, and the pointer in it.
fn large(
    ui: &Ui,
    rect: Rect,
    view: &ScreenInput<'_>,
    index: usize,
    view_state: &mut ViewState,
    commands: &mut Vec<Command>,
) -> Canvas {
    let scene = view.scene;
    let id = ui.id().with(("world view", index));
    // The panels' edges can be taken hold of from this side, too.
    let response = ui.interact(rect.shrink2(vec2(4.0, 0.0)), id, Sense::click_and_drag());
    set_arena_accessible_name(&response, index);
    let mut transform = ViewTransform::new(
        rect,
        MARGIN,
        view_state.camera,
        ArenaBounds::from_enclosure(&scene.scenario.enclosure),
    );
    let held = drag::update(ui, &response, &transform, view, index, commands);
    if response.clicked() || held.is_some() {
        view_state.followed = index;
    }
    let pointed = response.hover_pos().filter(|_| response.contains_pointer());
    let object = match (&held, pointed, scene.arenas.get(index)) {
        (Some(held), _, _) => Some(held.object),
        (None, Some(at), Some(arena)) if !response.dragged() => drag::hit_test(&transform, scene, arena, at),
        _ => None,
    };
    steer_camera(ui, &response, &mut transform, &mut view_state.camera, object.is_none());
    let canvas =
        Canvas { painter: ui.painter_at(rect), transform, palette: Palette::from_ui(ui), compact: false };
    if let Some(arena) = scene.arenas.get(index) {
        draw_large(ui, &canvas, scene, index, arena, view_state, id);
        draw_drag_feedback(ui, &response, &canvas, arena, object, held.as_ref());
    }
    canvas
}

/// Pan, zoom and fit; pan and fit only with a hand that is `empty`.
pub fn steer_camera(
    ui: &Ui,
    response: &Response,
    transform: &mut ViewTransform,
    camera: &mut ViewCamera,
    empty: bool,
) {
    let before = *camera;
    if empty && response.dragged() {
        *camera = transform.panned(*camera, response.drag_delta());
        ui.ctx().set_cursor_icon(CursorIcon::AllScroll);
    }
    if let Some(at) = response.hover_pos().filter(|_| response.contains_pointer()) {
        let (scroll, pinch) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
        let factor = pinch * (scroll * 0.0035).exp();
        if factor.is_finite() && factor != 1.0 {
            *camera = transform.zoomed(*camera, at, factor);
        }
    }
    if response.double_clicked() && empty {
        *camera = ViewCamera::default();
    }
    if *camera != before {
        *transform = transform.with_camera(*camera);
    }
}

fn draw_large(
    ui: &Ui,
    canvas: &Canvas,
    scene: &Scene,
    index: usize,
    arena: &ArenaScene,
    view_state: &ViewState,
    id: Id,
) {
    let (scenario, overlays, dark) = (&*scene.scenario, &view_state.overlays, ui.visuals().dark_mode);
    let here = index == view_state.followed;
    let value = scene.value.as_deref().filter(|_| here && overlays.value);
    let potential = scene.potential.as_deref().filter(|_| here && overlays.potential);
    let field =
        value.map(|field| (FieldKind::Value, field)).or(potential.map(|field| (FieldKind::Potential, field)));
    arena::draw_floor(canvas, &scenario.enclosure);
    if let Some((kind, field)) = field {
        field_view::draw_heatmap(canvas, kind, field, dark);
    }
    if let Some(field) = potential {
        field_view::draw_arrows(canvas, field, canvas.palette.text.gamma_multiply(0.45));
    }
    arena::draw_trajectories(canvas, arena, overlays);
    arena::draw_solids(canvas, &arena.scenario, &arena.obstacles);
    arena::draw_goal(canvas, scenario, [arena.goal.x_m, arena.goal.y_m]);
    let beams = overlays.beams && !arena.inactive;
    let label = beams.then(|| beams::draw(canvas, scenario, arena)).flatten();
    arena::draw_robot(canvas, scenario, arena.pose, arena::robot_color(canvas, arena));
    // Of two beside each other, one explains for both.
    let explains = index == 0 || !is_pair(scene);
    let beams =
        overlays.beams && if is_pair(scene) { scene.arenas.iter().any(|a| !a.inactive) } else { beams };
    let slope = overlays.potential && scene.potential.is_some();
    let shown = Overlays { beams, potential: slope, ..*overlays };
    let mut taken: Vec<Rect> = label.into_iter().collect();
    taken.extend(explains.then(|| legend::draw(canvas, &shown)).flatten());
    taken.extend(field.and_then(|(kind, field)| field_view::draw_color_bar(canvas, kind, field, dark)));
    if overlays.q_values && !arena.inactive {
        q_bars::draw(canvas, scenario, arena, &taken, id.with("q side"));
    }
}

/// Shows what the pointer could take hold of or holds.
fn draw_drag_feedback(
    ui: &Ui,
    response: &Response,
    canvas: &Canvas,
    arena: &ArenaScene,
    object: Option<Movable>,
    held: Option<&ActiveDrag>,
) {
    let (palette, Some(object)) = (&canvas.palette, object) else { return };
    let to_m = held.filter(|held| held.rejection.is_some()).map(|held| held.to_m);
    let Some(outline) = drag::silhouette(arena, object, to_m) else { return };
    if let Movable::Obstacle(obstacle) = object
        && let Some(obstacle) = arena.scenario.obstacles.get(obstacle)
    {
        obstacle_paths::draw(canvas, obstacle, palette.weak_text);
    }
    let around = outline.clone().inflated(4.5 / canvas.transform.scale);
    let clear = egui::Color32::TRANSPARENT;
    match held {
        Some(ActiveDrag { rejection: Some(why), to_m, .. }) => {
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
                &why.to_string(),
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

/// What a screen reader calls an arena's view.
fn set_arena_accessible_name(response: &Response, index: usize) {
    let words = format!("Arena {}", index + 1);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::Other, true, &words));
}
