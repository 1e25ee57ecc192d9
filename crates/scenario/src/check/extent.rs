//! How far an obstacle reaches beyond the enclosure, at any moment of its way.
//!
//! In: the enclosure, an obstacle. Out: metres, 0 or less when all of it stays inside. What a convex shape covers on a
//! straight leg is bounded by its sides at both ends of the leg and by the ways of its corners: those lines are looked
//! at, each from end to end.

use std::cell::Cell;

use crate::geometry::{enclosure_distance, length, max_distance_from};
use crate::schema::*;
use glam::{Vec2, vec2};

/// So far is allowed, in m: rounding.
pub(super) const TOLERANCE_M: f32 = 1e-4;
/// A corner of the enclosure that points inwards is found where it stands out by more than about this, in m.
const FINE_M: f32 = 0.01;
/// So many points between corners are looked at in one scenario: a hostile file ends before it takes long.
const MAX_SAMPLED_POINTS: u32 = 100_000;

/// The enclosure, and what work it has taken.
pub(super) struct EnclosureExtent<'a> {
    enclosure: &'a Enclosure,
    /// Whether it has no corner that points inwards: then what has its ends inside is inside.
    convex: bool,
    points_left: Cell<u32>,
}

/// Whether an obstacle ever leaves its place.
pub(super) fn moves(obstacle: &Obstacle) -> bool {
    match obstacle.motion {
        ObstacleMotion::Static => false,
        ObstacleMotion::Orbit { speed_rad_s, .. } => speed_rad_s != 0.0,
        ObstacleMotion::Patrol { speed_m_s, .. }
        | ObstacleMotion::BackAndForth { speed_m_s, .. }
        | ObstacleMotion::RandomWalk { speed_m_s, .. } => speed_m_s != 0.0,
    }
}

/// A shape as points, turned by `rotation_rad` about its middle, and a radius: it is all that is no farther than the
/// radius from the points' convex hull.
pub(super) fn support_points(shape: &Shape, rotation_rad: f32) -> (Vec<Vec2>, f32) {
    let (points, radius) = match shape {
        Shape::Circle { radius_m } => (vec![Vec2::ZERO], *radius_m),
        Shape::Rectangle { width_m, height_m } => {
            let (w, h) = (width_m / 2.0, height_m / 2.0);
            (vec![vec2(-w, -h), vec2(w, -h), vec2(w, h), vec2(-w, h)], 0.0)
        }
        Shape::Polygon { corners_m } => (corners_m.clone(), 0.0),
        Shape::Capsule { length_m, radius_m } => {
            (vec![vec2(-length_m / 2.0, 0.0), vec2(length_m / 2.0, 0.0)], *radius_m)
        }
    };
    let (sin, cos) = libm::sincosf(rotation_rad);
    let turned = |Vec2 { x, y }: Vec2| vec2(x * cos - y * sin, x * sin + y * cos);
    (points.into_iter().map(turned).collect(), radius)
}

impl<'a> EnclosureExtent<'a> {
    pub(super) fn new(enclosure: &'a Enclosure) -> Self {
        let convex = match enclosure {
            Enclosure::Rectangle { .. } => true,
            Enclosure::Polygon { .. } => {
                let corners = enclosure.corners_m();
                let n = corners.len();
                (0..n).all(|k| {
                    let [a, b, c] = [k, k + 1, k + 2].map(|k| corners[k % n]);
                    (b.x - a.x) * (c.y - b.y) >= (b.y - a.y) * (c.x - b.x)
                })
            }
        };
        Self { enclosure, convex, points_left: Cell::new(MAX_SAMPLED_POINTS) }
    }

    /// How far `obstacle` reaches beyond the enclosure on its whole way, in m.
    pub(super) fn overhang_m(&self, obstacle: &Obstacle) -> f32 {
        let (points, mut margin) = support_points(&obstacle.shape, obstacle.rotation_rad);
        let mut around = obstacle.shape.bounding_radius_m();
        let start = obstacle.position_m;
        let way = match (&obstacle.motion, obstacle.path_m()) {
            _ if !moves(obstacle) => vec![start],
            // It turns with the revolution, so that its farthest point draws a circle about the centre.
            (ObstacleMotion::Orbit { centre_m, .. }, _) => {
                return max_distance_from(obstacle, *centre_m)
                    - enclosure_distance(self.enclosure, *centre_m);
            }
            (ObstacleMotion::RandomWalk { radius_m, .. }, _) => {
                margin += radius_m;
                around += radius_m;
                vec![start]
            }
            (_, Some((mut path, closed))) => {
                path.extend(closed.then_some(start));
                path
            }
            (_, None) => vec![start],
        };
        let mut worst = f32::NEG_INFINITY;
        let mut last: Option<(Vec2, f32)> = None;
        for &stop in &way {
            let past = around - enclosure_distance(self.enclosure, stop);
            if past > 0.0 {
                worst = worst.max(self.at(&points, stop, margin));
            }
            if let Some((from, past_there)) = last {
                let leg = length(stop.x - from.x, stop.y - from.y);
                // Nothing of the leg is farther from an end with room than its half.
                if !self.convex && past + past_there + leg > 0.0 {
                    for point in &points {
                        let (a, b) = (plus(from, *point), plus(stop, *point));
                        worst = worst.max(self.segment_overhang_m(a, b, margin));
                    }
                }
            }
            last = Some((stop, past));
        }
        worst
    }

    /// How far the line between two points reaches beyond the enclosure, in m, if all that is nearer than `margin`
    /// to it counts.
    pub(super) fn segment_overhang_m(&self, from: Vec2, to: Vec2, margin: f32) -> f32 {
        let past = |place| margin - enclosure_distance(self.enclosure, place);
        self.between((from, past(from)), (to, past(to)), margin)
    }

    /// The same for a shape that stands at `stop`.
    fn at(&self, points: &[Vec2], stop: Vec2, margin: f32) -> f32 {
        let corner = |k: usize| plus(stop, points[k % points.len()]);
        let sides = (0..points.len()).map(|k| self.segment_overhang_m(corner(k), corner(k + 1), margin));
        sides.fold(f32::NEG_INFINITY, f32::max)
    }

    /// The line between two points of which it is known how far they are beyond.
    fn between(&self, from: (Vec2, f32), to: (Vec2, f32), margin: f32) -> f32 {
        let worst = from.1.max(to.1);
        let long = length(to.0.x - from.0.x, to.0.y - from.0.y);
        // A distance changes by no more than one goes.
        let most = (from.1 + to.1 + long) / 2.0;
        if self.convex || long < FINE_M || most <= worst.max(TOLERANCE_M) || self.points_left.get() == 0 {
            return worst;
        }
        self.points_left.set(self.points_left.get() - 1);
        let place = (from.0 + to.0) / 2.0;
        let middle = (place, margin - enclosure_distance(self.enclosure, place));
        self.between(from, middle, margin).max(self.between(middle, to, margin))
    }
}

fn plus(a: Vec2, b: Vec2) -> Vec2 {
    vec2(a.x + b.x, a.y + b.y)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn obstacle(shape: Shape, position_m: Vec2, motion: ObstacleMotion) -> Obstacle {
        Obstacle { shape, position_m, rotation_rad: 0.0, motion }
    }

    /// A U: 4 m x 2 m, with a notch from above, 1 m wide and 1.5 m deep.
    fn u() -> Enclosure {
        Enclosure::Polygon {
            corners_m: vec![
                vec2(-2.0, -1.0),
                vec2(2.0, -1.0),
                vec2(2.0, 1.0),
                vec2(0.5, 1.0),
                vec2(0.5, -0.5),
                vec2(-0.5, -0.5),
                vec2(-0.5, 1.0),
                vec2(-2.0, 1.0),
            ],
        }
    }

    fn assert_beyond(enclosure: &Enclosure, obstacle: &Obstacle, expected: f32) {
        let beyond = EnclosureExtent::new(enclosure).overhang_m(obstacle);
        assert!((beyond - expected).abs() < 0.01, "{obstacle:?}: {beyond}, not {expected}");
    }

    #[test]
    fn a_bar_across_a_notch_has_its_ends_inside_and_its_middle_not() {
        let bar = Shape::Rectangle { width_m: 2.0, height_m: 0.1 };
        let still = |y| obstacle(bar.clone(), vec2(0.0, y), ObstacleMotion::Static);
        // In the notch's middle its walls are 0.5 m away on both sides.
        assert_beyond(&u(), &still(0.3), 0.5);
        assert_beyond(&u(), &still(-0.4), 0.15);
        assert!(EnclosureExtent::new(&u()).overhang_m(&still(-0.75)) <= 0.0, "below the notch there is room");
        let rod = Shape::Capsule { length_m: 1.8, radius_m: 0.05 };
        assert_beyond(&u(), &obstacle(rod, vec2(0.0, 0.3), ObstacleMotion::Static), 0.55);
    }

    #[test]
    fn a_patrol_may_stop_in_both_arms_and_still_cross_the_notch() {
        let ball = Shape::Circle { radius_m: 0.2 };
        let patrol = |waypoints_m| ObstacleMotion::Patrol { waypoints_m, speed_m_s: 0.1 };
        assert_beyond(&u(), &obstacle(ball.clone(), vec2(-1.0, 0.3), patrol(vec![vec2(1.0, 0.3)])), 0.7);
        // Down, across below the notch, up; but the way home from there leads through it.
        let around = vec![vec2(-1.0, -0.75), vec2(1.0, -0.75), vec2(1.0, 0.3)];
        assert_beyond(&u(), &obstacle(ball.clone(), vec2(-1.0, 0.3), patrol(around.clone())), 0.7);
        let back = ObstacleMotion::BackAndForth { waypoints_m: around, speed_m_s: 0.1 };
        assert!(
            EnclosureExtent::new(&u()).overhang_m(&obstacle(ball, vec2(-1.0, 0.3), back)) <= 0.0,
            "the same way back is free"
        );
    }

    #[test]
    fn in_a_rectangle_the_ends_of_the_way_decide() {
        let square = Enclosure::Rectangle { width_m: 4.0, height_m: 4.0 };
        let ball = Shape::Circle { radius_m: 0.15 };
        let walk = |radius_m, speed_m_s| ObstacleMotion::RandomWalk { radius_m, speed_m_s, seed: 1 };
        assert_beyond(&square, &obstacle(ball.clone(), vec2(1.0, 0.0), walk(0.9, 0.1)), 0.05);
        let stays =
            EnclosureExtent::new(&square).overhang_m(&obstacle(ball.clone(), vec2(1.0, 0.0), walk(0.9, 0.0)));
        assert!(stays <= 0.0, "without speed it stays");
        // 1 m from the centre (0.5, 0), and 0.15 m more: 1.65 m along x, where there are 2 m.
        let orbit = |speed_rad_s| ObstacleMotion::Orbit { centre_m: vec2(0.5, 0.0), speed_rad_s };
        assert_beyond(&square, &obstacle(ball.clone(), vec2(0.5, 1.0), orbit(0.1)), -0.35);
        assert_beyond(&square, &obstacle(ball, vec2(0.5, 1.9), orbit(0.1)), 0.55);
        let corners_m = vec![vec2(0.0, -0.1), vec2(1.0, 0.0), vec2(0.0, 0.1)];
        assert_beyond(
            &square,
            &obstacle(Shape::Polygon { corners_m }, vec2(1.5, 0.0), ObstacleMotion::Static),
            0.5,
        );
    }
}
