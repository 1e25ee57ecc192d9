//! The handles of what is selected, as knobs on the screen, with the number that one changes beside it.
//!
//! In: the [`Editor`]. Out: where the knobs are, which one is under the pointer, and their picture.

use bevy::math;
use egui::{Align2, FontId, Pos2, Rect, Stroke, StrokeKind, Vec2, vec2};

use super::pointer::PointerHit;
use crate::app::editor::{Editor, Handle, HandleKind, Selection};
use crate::app::screen::arena_view::canvas::Canvas;
use crate::app::screen::arena_view::silhouette::Silhouette;
use crate::app::screen::arena_view::transform::ViewTransform;
use crate::app::screen::theme::SMALL;

/// Half the side of a knob, in points.
const HALF: f32 = 4.0;
/// From the thing's outline to the knob that turns it, in points.
const TURN: f32 = 26.0;
/// Knobs nearer to the middle than this are hidden, or a small thing could not be taken hold of.
const MIN_DISTANCE: f32 = 11.0;
/// Knobs that put a new corner in need so much room to their neighbours.
const MIN_SPACING: f32 = 17.0;

/// A handle on the screen.
#[derive(Clone, Debug, PartialEq)]
pub struct ScreenHandle {
    /// What it is of.
    pub handle: Handle,
    /// Its middle.
    pub at: Pos2,
}

/// Those of what is selected; later ones lie on top.
pub fn screen_handles(transform: &ViewTransform, editor: &Editor) -> Vec<ScreenHandle> {
    let knobs = editor.handles().into_iter().map(|handle| {
        let at = match handle.kind {
            HandleKind::Rotate => turning(transform, editor, &handle),
            _ => transform.to_screen(handle.position_m.into()),
        };
        ScreenHandle { handle, at }
    });
    let all: Vec<ScreenHandle> = knobs.filter(|knob| knob.at.is_finite()).collect();
    let middle = all.iter().find(|knob| knob.handle.kind == HandleKind::Middle).map(|knob| knob.at);
    // One corner may lie near the middle; with all of them there the thing is small.
    let is_outer = |knob: &ScreenHandle| middle.is_none_or(|middle| middle.distance(knob.at) >= MIN_DISTANCE);
    let is_small =
        !all.iter().any(|knob| matches!(knob.handle.kind, HandleKind::Corner(_)) && is_outer(knob));
    let dragged = editor.dragged();
    let has_room = |knob: &&ScreenHandle| {
        let near = |other: Pos2, least: f32| other.distance(knob.at) < least;
        let kind = knob.handle.kind;
        match kind {
            _ if dragged == Some(kind) => true,
            HandleKind::InsertCorner(_) | HandleKind::InsertWaypoint(_) => {
                !all.iter().any(|other| !other.handle.kind.is_insert() && near(other.at, MIN_SPACING))
            }
            // Between two corners of a short side.
            HandleKind::Side(0, _) | HandleKind::Side(_, 0)
                if all.iter().any(|other| is_corner(other.handle.kind) && near(other.at, MIN_DISTANCE)) =>
            {
                false
            }
            HandleKind::Side(..) | HandleKind::Radius | HandleKind::CapsuleEnd(_) => is_outer(knob),
            HandleKind::Corner(_) => !is_small,
            _ => true,
        }
    };
    all.iter().filter(has_room).cloned().collect()
}

fn is_corner(kind: HandleKind) -> bool {
    matches!(kind, HandleKind::Side(x, y) if x != 0 && y != 0)
}

/// What turns something is as far beyond it on the screen whatever the zoom.
fn turning(transform: &ViewTransform, editor: &Editor, handle: &Handle) -> Pos2 {
    let at = transform.to_screen(handle.position_m.into());
    let Some((about, _)) = editor.rotation_of() else { return at };
    let about = transform.to_screen(about.into());
    let along = (at - about).normalized();
    let reach_m = match editor.selection() {
        Selection::Obstacle(k) => {
            editor.scenario().obstacles.get(k).map(|o| Silhouette::from_obstacle(o).reach_m())
        }
        _ => Some(editor.scenario().robot.radius_m),
    };
    about + along * (transform.to_screen_length(reach_m.unwrap_or(0.0)).max(8.0) + TURN)
}

/// The middle of what is selected, on the screen, if its size is measured from there.
pub fn center(transform: &ViewTransform, editor: &Editor) -> Option<Pos2> {
    let scenario = editor.scenario();
    let between = |a: math::Vec2, b: math::Vec2| [(a.x + b.x) / 2.0, (a.y + b.y) / 2.0];
    let knobs = editor.handles();
    let center_m = match editor.selection() {
        Selection::Obstacle(k) => scenario.obstacles.get(k).map(|obstacle| obstacle.position_m.into()),
        Selection::Enclosure => {
            let (low, high) = scenario.enclosure.bounds_m();
            Some(between(low, high))
        }
        _ => {
            let corner =
                |x, y| knobs.iter().find(|knob| knob.kind == HandleKind::Side(x, y)).map(|k| k.position_m);
            corner(-1, -1).zip(corner(1, 1)).map(|(a, b)| between(a, b))
        }
    }?;
    Some(transform.to_screen(center_m))
}

/// The nearest knob within `reach` points of `at`. Where a path begins the whole thing is taken, or with `shift` the
/// thing alone.
pub fn hit_test(knobs: &[ScreenHandle], at: Pos2, reach: f32, shift: bool) -> Option<HandleKind> {
    let has_start = knobs.iter().any(|knob| knob.handle.kind == HandleKind::PathStart);
    let hidden = if shift && has_start { HandleKind::Middle } else { HandleKind::PathStart };
    let away = |knob: &ScreenHandle| {
        // What makes something new gives way to what is there.
        knob.at.distance(at) + if knob.handle.kind.is_insert() { 3.0 } else { 0.0 }
    };
    let open = knobs.iter().rev().filter(|knob| knob.handle.kind != hidden && away(knob) <= reach);
    open.min_by(|a, b| away(a).total_cmp(&away(b))).map(|knob| knob.handle.kind)
}

/// Draws them, and beside the one that is under the pointer or in the hand its number.
pub fn draw(canvas: &Canvas, editor: &Editor, under: PointerHit) {
    let knobs = screen_handles(&canvas.transform, editor);
    let (painter, palette) = (&canvas.painter, &canvas.palette);
    let lit = match under {
        PointerHit::Handle(kind) => Some(kind),
        _ => None,
    };
    // The others would only be in the way of what is dragged.
    let alone = editor.dragged();
    for knob in &knobs {
        let (kind, at) = (knob.handle.kind, knob.at);
        // A mark has its own middle.
        let is_mark = matches!(editor.selection(), Selection::BenchmarkStart | Selection::BenchmarkGoal);
        if is_mark && kind == HandleKind::Middle && lit != Some(kind) {
            continue;
        }
        if kind == HandleKind::PathStart && lit != Some(kind) || alone.is_some_and(|dragged| dragged != kind)
        {
            continue;
        }
        let on = lit == Some(kind);
        let (fill, half) = if on { (palette.accent, HALF + 1.0) } else { (palette.floor, HALF) };
        let edge = Stroke::new(1.5, palette.accent);
        match kind {
            HandleKind::Side(..) => {
                let square = Rect::from_center_size(at, Vec2::splat(2.0 * half));
                painter.rect(square, 1.5, fill, edge, StrokeKind::Middle);
            }
            HandleKind::Middle if !on => {
                painter.circle(at, 2.5, palette.accent, Stroke::new(1.0, palette.floor));
            }
            HandleKind::InsertCorner(_) | HandleKind::InsertWaypoint(_) => {
                painter.circle(at, half, palette.floor, Stroke::new(1.0, palette.accent.gamma_multiply(0.7)));
                let ink = Stroke::new(1.25, palette.accent);
                for way in [vec2(half - 1.5, 0.0), vec2(0.0, half - 1.5)] {
                    painter.line_segment([at - way, at + way], ink);
                }
            }
            HandleKind::Rotate => {
                if let Some((about, _)) = editor.rotation_of() {
                    let stalk = (at - canvas.to_screen(about.into())).normalized();
                    painter.line_segment([at - stalk * (TURN - 4.0), at], Stroke::new(1.5, palette.accent));
                }
                painter.circle(at, half, fill, edge);
            }
            _ => {
                painter.circle(at, half, fill, edge);
            }
        }
    }
    // Over all of them.
    if let Some(knob) = knobs.iter().find(|knob| Some(knob.handle.kind) == lit) {
        let text = &knob.handle.text;
        let size = painter.layout_no_wrap(text.clone(), FontId::proportional(SMALL), palette.text).size();
        let away = vec2(HALF + 9.0, HALF + 5.0);
        // To the upper right, or where no other knob is.
        let places = [
            (vec2(away.x, -away.y), Align2::LEFT_BOTTOM),
            (away, Align2::LEFT_TOP),
            (-away, Align2::RIGHT_BOTTOM),
            (vec2(-away.x, away.y), Align2::RIGHT_TOP),
        ];
        let is_free = |(shift, anchor): &(Vec2, Align2)| {
            let chip = anchor.anchor_size(knob.at + *shift, size + vec2(8.0, 3.0));
            let covered = |other: &ScreenHandle| alone.is_none() && chip.expand(HALF).contains(other.at);
            canvas.transform.rect.contains_rect(chip) && !knobs.iter().any(covered)
        };
        let (shift, anchor) = places.into_iter().find(is_free).unwrap_or(places[0]);
        canvas.label(knob.at + shift, anchor, text, palette.text);
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::app::screen::arena_view::transform::ArenaBounds;
    use crate::app::view_state::ViewCamera;
    use crate::scenario::{Obstacle, ObstacleMotion, Scenario, Shape};

    fn knob(kind: HandleKind, x: f32) -> ScreenHandle {
        let handle = Handle { kind, position_m: math::vec2(0.0, 0.0), text: String::new(), about: "" };
        ScreenHandle { handle, at: Pos2::new(x, 0.0) }
    }

    #[test]
    fn the_nearest_knob_is_hit_and_a_new_corner_gives_way() {
        let knobs = [
            knob(HandleKind::InsertCorner(1), 6.0),
            knob(HandleKind::Corner(0), 0.0),
            knob(HandleKind::Corner(1), 40.0),
        ];
        let hit = |x: f32| super::hit_test(&knobs, Pos2::new(x, 0.0), 9.0, false);
        assert_eq!(hit(1.0), Some(HandleKind::Corner(0)));
        assert_eq!(hit(4.0), Some(HandleKind::Corner(0)), "the other is nearer, but makes something new");
        assert_eq!(hit(7.0), Some(HandleKind::InsertCorner(1)));
        assert_eq!(hit(49.5), None);
    }

    #[test]
    fn a_small_box_shows_its_corners_only_and_a_tiny_one_none() {
        let block = Obstacle {
            shape: Shape::Rectangle { width_m: 0.2, height_m: 0.2 },
            position_m: math::vec2(0.5, 0.5),
            rotation_rad: 0.0,
            motion: ObstacleMotion::Static,
        };
        let scenario = Scenario { obstacles: vec![block], ..Scenario::default() };
        let bounds = ArenaBounds::from_enclosure(&scenario.enclosure);
        let mut editor = Editor::open(Arc::new(scenario), "mine.ron".into(), true);
        editor.select(Selection::Obstacle(0));
        // The world is 4 m wide, the box 30, 18 or 8 points.
        for (side, shown) in [(600.0, 8), (360.0, 4), (160.0, 0)] {
            let view = Rect::from_min_size(Pos2::ZERO, Vec2::splat(side));
            let transform = ViewTransform::new(view, Vec2::ZERO, ViewCamera::default(), bounds);
            let all = screen_handles(&transform, &editor);
            let sides = all.iter().filter(|knob| matches!(knob.handle.kind, HandleKind::Side(..)));
            assert_eq!(sides.count(), shown, "{side}");
            assert!(all.iter().any(|knob| knob.handle.kind == HandleKind::Middle), "it can be moved");
        }
    }

    #[test]
    fn where_a_path_begins_shift_takes_the_obstacle_alone() {
        let knobs = [knob(HandleKind::PathStart, 0.0), knob(HandleKind::Middle, 0.0)];
        let hit = |shift| super::hit_test(&knobs, Pos2::new(0.0, 0.0), 9.0, shift);
        assert_eq!([hit(false), hit(true)], [Some(HandleKind::Middle), Some(HandleKind::PathStart)]);
        assert_eq!(super::hit_test(&knobs[1..], Pos2::new(0.0, 0.0), 9.0, true), Some(HandleKind::Middle));
    }
}
