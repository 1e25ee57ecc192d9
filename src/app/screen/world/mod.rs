//! The world view: one arena large, all as a grid, or two side by side; with the camera and the hand on the world.
//!
//! In: the [`View`]. Out: the picture, changes of the [`Desk`] (camera, which arena is followed), and the orders of what
//! is dragged.
//!
//! | file | duty |
//! |---|---|
//! | `plane.rs` | metres to points and back, and the camera |
//! | `canvas.rs` | what is drawn with: ribbons, chips, cards |
//! | `arena.rs` | floor, walls, obstacles, target, robot, ways |
//! | `outline.rs`, `polygon.rs` | the shapes of things; the floor, wherever its corners point |
//! | `motions.rs` | where moving obstacles go |
//! | `beams.rs` | the LIDAR's beams |
//! | `q_bars.rs` | the Q-values beside the robot |
//! | `field_view.rs`, `field_picture.rs` | the potential and the value over the plane; their colours |
//! | `legend.rs` | what the marks mean |
//! | `cells.rs` | all arenas as a grid |
//! | `score.rs` | who drives, and how well so far |
//! | `grasp.rs` | what the pointer takes hold of and drags |
//! | `steer.rs` | the arrow keys in Drive mode |
//! | `welcome.rs` | the call to a first-time user |

pub mod arena;
mod beams;
pub mod canvas;
mod cells;
mod field_picture;
mod field_view;
mod grasp;
mod legend;
pub mod motions;
pub mod outline;
pub mod plane;
pub mod polygon;
mod q_bars;
mod score;
pub mod steer;
pub mod welcome;

use egui::{Align2, CursorIcon, FontId, Id, Rect, Response, Sense, Stroke, Ui, Vec2, vec2};

use self::canvas::Canvas;
use self::field_view::Kind;
use self::grasp::{Grip, Held};
use self::plane::{Bounds, Plane};
use crate::app::desk::{Camera, Desk, Overlays};
use crate::app::orders::Order;
use crate::app::scene::{ArenaScene, Driver, Scene};
use crate::app::screen::View;
use crate::app::screen::theme::{Inks, SMALL};

/// Space around the walls in a large view, where the legend and the key to a field are.
const MARGIN: Vec2 = vec2(18.0, 34.0);

/// Fills what is left of `ui` with the world.
pub fn show(ui: &mut Ui, view: &View<'_>, desk: &mut Desk, orders: &mut Vec<Order>) {
    let scene = view.scene;
    let rect = ui.available_rect_before_wrap();
    ui.advance_cursor_after_rect(rect);
    if !rect.is_positive() || scene.arenas.is_empty() {
        return;
    }
    ui.painter_at(rect).rect_filled(rect, 0.0, Inks::of(ui).paper);
    desk.followed = desk.followed.min(scene.arenas.len() - 1);
    if is_pair(scene) {
        pair(ui, rect, view, desk, orders);
    } else if is_alone(scene) {
        headed(ui, rect, view, 0, desk, orders);
    } else if desk.grid && scene.arenas.len() > 1 {
        cells::grid(ui, rect, scene, desk);
    } else {
        let index = desk.followed;
        let canvas = large(ui, rect, view, index, desk, orders);
        if scene.arenas.len() > 1 {
            let words = format!("Arena {} of {}", index + 1, scene.arenas.len());
            let at = rect.min + vec2(14.0, 16.0);
            let font = FontId::proportional(SMALL);
            let galley = canvas.painter.layout_no_wrap(words, font, canvas.inks.soft);
            let corner = at - vec2(0.0, galley.size().y / 2.0);
            canvas.strip(Rect::from_min_size(corner, galley.size()).expand2(vec2(6.0, 3.0)));
            canvas.painter.galley(corner, galley, canvas.inks.soft);
        }
    }
}

/// Two arenas that are driven by different drivers are always seen side by side.
fn is_pair(scene: &Scene) -> bool {
    matches!(&scene.arenas[..], [a, b] if a.driver != b.driver)
}

/// One arena that a policy drives alone.
fn is_alone(scene: &Scene) -> bool {
    matches!(&scene.arenas[..], [only] if matches!(only.driver, Driver::Policy(_)))
}

fn pair(ui: &mut Ui, rect: Rect, view: &View<'_>, desk: &mut Desk, orders: &mut Vec<Order>) {
    let line = Stroke::new(1.0, Inks::of(ui).line);
    let (first, second) = if rect.width() >= rect.height() * 0.9 {
        ui.painter_at(rect).vline(rect.center().x, rect.y_range(), line);
        rect.split_left_right_at_fraction(0.5)
    } else {
        ui.painter_at(rect).hline(rect.x_range(), rect.center().y, line);
        rect.split_top_bottom_at_fraction(0.5)
    };
    for (index, part) in [first, second].into_iter().enumerate() {
        headed(ui, part, view, index, desk, orders);
    }
}

/// One arena, under a header that says who drives there and how well.
fn headed(ui: &Ui, part: Rect, view: &View<'_>, index: usize, desk: &mut Desk, orders: &mut Vec<Order>) {
    let (header, below) = part.split_top_bottom_at_y(part.top() + score::HEIGHT);
    let below = below.shrink2(vec2(1.0, 0.0));
    large(ui, below, view, index, desk, orders);
    if let Some(arena) = view.scene.arenas.get(index) {
        // As wide as the arena is when it fits.
        let bounds = Bounds::of(&view.scene.scenario.enclosure);
        let fit = Plane::new(below, MARGIN, Camera::default(), bounds);
        score::draw(ui, header, fit.bounds_rect().width(), arena);
    }
}

/// One arena with everything, and the pointer in it.
fn large(
    ui: &Ui,
    rect: Rect,
    view: &View<'_>,
    index: usize,
    desk: &mut Desk,
    orders: &mut Vec<Order>,
) -> Canvas {
    let scene = view.scene;
    let id = ui.id().with(("world view", index));
    // The panels' edges can be taken hold of from this side, too.
    let response = ui.interact(rect.shrink2(vec2(4.0, 0.0)), id, Sense::click_and_drag());
    name_for_readers(&response, index);
    let mut plane = Plane::new(rect, MARGIN, desk.camera, Bounds::of(&scene.scenario.enclosure));
    let held = grasp::follow(ui, &response, &plane, view, index, orders);
    if response.clicked() || held.is_some() {
        desk.followed = index;
    }
    let pointed = response.hover_pos().filter(|_| response.contains_pointer());
    let grip = match (&held, pointed, scene.arenas.get(index)) {
        (Some(held), _, _) => Some(held.grip),
        (None, Some(at), Some(arena)) if !response.dragged() => grasp::under(&plane, scene, arena, at),
        _ => None,
    };
    steer_camera(ui, &response, &mut plane, &mut desk.camera, grip.is_none());
    let canvas = Canvas { painter: ui.painter_at(rect), plane, inks: Inks::of(ui), small: false };
    if let Some(arena) = scene.arenas.get(index) {
        draw_large(ui, &canvas, scene, index, arena, desk, id);
        mark_hand(ui, &response, &canvas, arena, grip, held);
    }
    canvas
}

/// Pan, zoom and fit; pan and fit only with a hand that is `empty`.
pub fn steer_camera(ui: &Ui, response: &Response, plane: &mut Plane, camera: &mut Camera, empty: bool) {
    let before = *camera;
    if empty && response.dragged() {
        *camera = plane.panned(*camera, response.drag_delta());
        ui.ctx().set_cursor_icon(CursorIcon::AllScroll);
    }
    if let Some(at) = response.hover_pos().filter(|_| response.contains_pointer()) {
        let (scroll, pinch) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
        let factor = pinch * (scroll * 0.0035).exp();
        if factor.is_finite() && factor != 1.0 {
            *camera = plane.zoomed(*camera, at, factor);
        }
    }
    if response.double_clicked() && empty {
        *camera = Camera::default();
    }
    if *camera != before {
        *plane = plane.through(*camera);
    }
}

fn draw_large(
    ui: &Ui,
    canvas: &Canvas,
    scene: &Scene,
    index: usize,
    arena: &ArenaScene,
    desk: &Desk,
    id: Id,
) {
    let (scenario, overlays, dark) = (&*scene.scenario, &desk.overlays, ui.visuals().dark_mode);
    let here = index == desk.followed;
    let value = scene.value.as_deref().filter(|_| here && overlays.value);
    let potential = scene.potential.as_deref().filter(|_| here && overlays.potential);
    let field = value.map(|field| (Kind::Value, field)).or(potential.map(|field| (Kind::Potential, field)));
    arena::ground(canvas, &scenario.enclosure);
    if let Some((kind, field)) = field {
        field_view::colours(canvas, kind, field, dark);
    }
    if let Some(field) = potential {
        field_view::arrows(canvas, field, canvas.inks.ink.gamma_multiply(0.45));
    }
    arena::ways(canvas, arena, overlays);
    arena::solids(canvas, &arena.room, &arena.obstacles);
    arena::target(canvas, scenario, [arena.target.x_m, arena.target.y_m]);
    let beams = overlays.beams && !arena.parked;
    let label = beams.then(|| beams::draw(canvas, scenario, arena)).flatten();
    arena::robot(canvas, scenario, arena.pose, arena::skin(canvas, arena));
    // Of two beside each other, one explains for both.
    let explains = index == 0 || !is_pair(scene);
    let beams = overlays.beams && if is_pair(scene) { scene.arenas.iter().any(|a| !a.parked) } else { beams };
    let slope = overlays.potential && scene.potential.is_some();
    let shown = Overlays { beams, potential: slope, ..*overlays };
    let mut taken: Vec<Rect> = label.into_iter().collect();
    taken.extend(explains.then(|| legend::draw(canvas, &shown)).flatten());
    taken.extend(field.and_then(|(kind, field)| field_view::key(canvas, kind, field, dark)));
    if overlays.q_values && !arena.parked {
        q_bars::draw(canvas, scenario, arena, &taken, id.with("q side"));
    }
}

/// Shows what the pointer could take hold of or holds.
fn mark_hand(
    ui: &Ui,
    response: &Response,
    canvas: &Canvas,
    arena: &ArenaScene,
    grip: Option<Grip>,
    held: Option<Held>,
) {
    let (inks, Some(grip)) = (&canvas.inks, grip) else { return };
    let to_m = held.and_then(|held| held.refused.map(|_| held.to_m));
    let Some(outline) = grasp::outline(arena, grip, to_m) else { return };
    if let Grip::Obstacle(obstacle) = grip
        && let Some(obstacle) = arena.room.obstacles.get(obstacle)
    {
        motions::draw(canvas, obstacle, inks.soft);
    }
    let around = outline.clone().grown(4.5 / canvas.plane.scale);
    let clear = egui::Color32::TRANSPARENT;
    match held {
        Some(Held { refused: Some(why), to_m, .. }) => {
            ui.ctx().set_cursor_icon(CursorIcon::NoDrop);
            outline::draw(canvas, &outline, inks.bad.gamma_multiply(0.35), Stroke::new(2.0, inks.bad));
            let below = vec2(0.0, canvas.plane.length(outline.reach_m()) + 7.0);
            canvas.chip(canvas.at(to_m) + below, Align2::CENTER_TOP, why, inks.bad);
        }
        Some(_) => {
            ui.ctx().set_cursor_icon(CursorIcon::Grabbing);
            outline::draw(canvas, &around, clear, Stroke::new(2.0, inks.ink));
        }
        None => {
            ui.ctx().set_cursor_icon(CursorIcon::Grab);
            outline::draw(canvas, &around, clear, Stroke::new(1.5, inks.ink.gamma_multiply(0.8)));
            response.clone().on_hover_text_at_pointer(grip.words());
        }
    }
}

/// What a screen reader calls an arena's view.
fn name_for_readers(response: &Response, index: usize) {
    let words = format!("Arena {}", index + 1);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::Other, true, &words));
}
