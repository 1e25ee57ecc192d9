//! The arena view: one arena, a grid of all arenas, or two side by side; with the camera, the overlays and dragging.
//!
//! In: the [`ScreenInput`]. Out: shapes, changes of the [`ViewState`] (camera, followed arena, drag), and
//! [`Command`]s that move a dragged object or set the goal.
//!
//! | file | purpose |
//! |---|---|
//! | `transform.rs`, `camera.rs` | metres to points and back; pan, zoom and fit |
//! | `canvas.rs` | what everything is drawn on: gradient lines, labels, arrowheads |
//! | `single_arena.rs` | one arena with everything over it |
//! | `arena_grid.rs` | the grid of all arenas |
//! | `floor.rs`, `arena.rs` | floor and grid lines; walls, obstacles, goal, robot |
//! | `silhouette.rs`, `polygon.rs` | outlines of objects; filling polygons |
//! | `obstacle_paths.rs` | the paths of moving obstacles |
//! | `trajectories.rs` | the robot's current path and past paths |
//! | `driver_plan.rs` | the map and the planned path of a driver |
//! | `beams.rs` | LIDAR beams |
//! | `q_card.rs`, `q_card_position.rs`, `motion_arrow.rs` | the Q-values next to the robot |
//! | `field_view.rs`, `field_image.rs`, `color_bar.rs` | potential and state value as colours, arrows down the potential |
//! | `legend.rs` | the legend |
//! | `score.rs` | driver, success rate and outcomes above an arena |
//! | `drag.rs`, `drag_target.rs` | dragging objects, and where they may be put |
//! | `goal_click.rs` | setting the goal by a click on free floor |
//! | `steer.rs` | the arrow keys in Drive mode |
//! | `welcome.rs` | the start button before the first training run |

pub mod arena;
mod arena_grid;
mod beams;
pub mod camera;
pub mod canvas;
mod color_bar;
mod drag;
mod drag_target;
mod driver_plan;
mod field_image;
mod field_view;
pub mod floor;
mod goal_click;
mod legend;
mod motion_arrow;
pub mod obstacle_paths;
pub mod polygon;
mod q_card;
mod q_card_position;
mod score;
pub mod silhouette;
pub mod single_arena;
pub mod steer;
mod trajectories;
pub mod transform;
pub mod welcome;

use egui::{FontId, Rect, Stroke, Ui, vec2};

use self::canvas::Canvas;
use self::single_arena::{MARGIN, is_pair, single_arena};
use self::transform::{ArenaBounds, ViewTransform};
use crate::app::commands::Command;
use crate::app::scene::{DriverLabel, Scene};
use crate::app::screen::input::ScreenInput;
use crate::app::screen::theme::{Palette, SMALL};
use crate::app::view_state::{ViewCamera, ViewState};

/// Fills the free space of `ui` with the arenas.
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
    } else if is_single_policy(scene) {
        with_score(ui, rect, view, 0, view_state, commands);
    } else if view_state.grid && scene.arenas.len() > 1 {
        arena_grid::arena_grid_ui(ui, rect, scene, view_state);
    } else {
        let index = view_state.followed;
        let canvas = single_arena(ui, rect, view, index, view_state, commands);
        if scene.arenas.len() > 1 {
            draw_arena_label(&canvas, rect, arena_words(scene, index));
        }
    }
}

/// Draws `words` about an arena in the upper left corner of `rect`.
fn draw_arena_label(canvas: &Canvas, rect: Rect, words: String) {
    let at = rect.min + vec2(14.0, 16.0);
    let font = FontId::proportional(SMALL);
    let galley = canvas.painter.layout_no_wrap(words, font, canvas.palette.weak_text);
    let corner = at - vec2(0.0, galley.size().y / 2.0);
    canvas.strip_background(Rect::from_min_size(corner, galley.size()).expand2(vec2(6.0, 3.0)));
    canvas.painter.galley(corner, galley, canvas.palette.weak_text);
}

/// The number of arena `index` and, in a set, its current scenario.
fn arena_words(scene: &Scene, index: usize) -> String {
    let words = format!("Arena {} of {}", index + 1, scene.arenas.len());
    match scene.arenas.get(index).and_then(|arena| arena.set_member.as_ref()) {
        Some(member) => format!("{words} · {member}"),
        None => words,
    }
}

/// Whether the scene has one arena only, driven by a policy.
fn is_single_policy(scene: &Scene) -> bool {
    matches!(&scene.arenas[..], [only] if matches!(only.driver, DriverLabel::Policy { .. }))
}

/// Draws two arenas side by side, or one above the other in a tall view.
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
        with_score(ui, part, view, index, view_state, commands);
    }
}

/// Draws one arena with its score above it.
fn with_score(
    ui: &Ui,
    part: Rect,
    view: &ScreenInput<'_>,
    index: usize,
    view_state: &mut ViewState,
    commands: &mut Vec<Command>,
) {
    let (header, below) = part.split_top_bottom_at_y(part.top() + score::HEIGHT);
    let below = below.shrink2(vec2(1.0, 0.0));
    let canvas = single_arena(ui, below, view, index, view_state, commands);
    if let Some(arena) = view.scene.arenas.get(index) {
        // As wide as the arena at zoom 1.
        let bounds = ArenaBounds::from_enclosure(&arena.written.enclosure);
        let fit = ViewTransform::new(below, MARGIN, ViewCamera::default(), bounds);
        score::draw(ui, ui.id().with(("score", index)), header, fit.bounds_rect().width(), arena);
        if let Some(member) = &arena.set_member {
            draw_arena_label(&canvas, below, member.clone());
        }
    }
}
