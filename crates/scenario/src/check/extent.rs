//! How far an obstacle extends outside the enclosure along its whole path.
//!
//! In: the enclosure and an obstacle. Out: a distance in m, 0 or negative if the obstacle stays inside. The area that a
//! convex shape covers on a straight leg is bounded by its sides at both ends of the leg and by the paths of its corners;
//! each of these lines is tested over its whole length.

use std::cell::Cell;

use crate::geometry::{enclosure_distance, length};
use crate::limits::MAX_SAMPLED_POINTS;
use crate::schema::*;
use crate::track::Track;
use glam::{Vec2, vec2};

/// Tolerance for rounding, in m.
pub(super) const TOLERANCE_M: f32 = 1e-4;
/// Resolution, in m, at which a concave corner of the enclosure is found.
const FINE_M: f32 = 0.01;

/// The enclosure, and the number of points that may still be tested.
pub(super) struct EnclosureExtent<'a> {
    enclosure: &'a Enclosure,
    /// Whether the enclosure is convex: then a line with both ends inside is inside.
    convex: bool,
    points_left: Cell<u32>,
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

    /// How far `obstacle` extends outside the enclosure along its whole path, in m.
    pub(super) fn overhang_m(&self, obstacle: &Obstacle) -> f32 {
        let (points, mut margin) = obstacle.shape.support_points(obstacle.rotation_rad);
        let mut bounding_radius = obstacle.shape.bounding_radius_m();
        let start = obstacle.position_m;
        let path = match obstacle.actual_track() {
            Track::Point => vec![start],
            // The obstacle rotates as it orbits, so its farthest point moves on a circle about the centre.
            Track::Circle { centre_m } => {
                return obstacle.max_distance_from(centre_m) - enclosure_distance(self.enclosure, centre_m);
            }
            Track::Disc { radius_m } => {
                margin += radius_m;
                bounding_radius += radius_m;
                vec![start]
            }
            Track::Lines { mut corners_m, closed } => {
                corners_m.extend(closed.then_some(start));
                corners_m
            }
        };
        let mut worst = f32::NEG_INFINITY;
        let mut last: Option<(Vec2, f32)> = None;
        for &stop in &path {
            let past = bounding_radius - enclosure_distance(self.enclosure, stop);
            if past > 0.0 {
                worst = worst.max(self.overhang_at_m(&points, stop, margin));
            }
            if let Some((from, past_there)) = last {
                let leg = length(stop.x - from.x, stop.y - from.y);
                // The distances of a point of the leg from both ends add up to `leg`, so the obstacle extends outside by at
                // most (past + past_there + leg) / 2 there.
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

    /// How far the area within `margin` of the line between two points extends outside the enclosure, in m.
    pub(super) fn segment_overhang_m(&self, from: Vec2, to: Vec2, margin: f32) -> f32 {
        let past = |point| margin - enclosure_distance(self.enclosure, point);
        self.between((from, past(from)), (to, past(to)), margin)
    }

    /// How far a shape at `stop`, given by its support points, extends outside the enclosure, in m.
    fn overhang_at_m(&self, points: &[Vec2], stop: Vec2, margin: f32) -> f32 {
        let corner = |k: usize| plus(stop, points[k % points.len()]);
        let sides = (0..points.len()).map(|k| self.segment_overhang_m(corner(k), corner(k + 1), margin));
        sides.fold(f32::NEG_INFINITY, f32::max)
    }

    /// Like [`Self::segment_overhang_m`], for two points that are given with their own overhangs.
    fn between(&self, from: (Vec2, f32), to: (Vec2, f32), margin: f32) -> f32 {
        let worst = from.1.max(to.1);
        let long = length(to.0.x - from.0.x, to.0.y - from.0.y);
        // The distance to the enclosure changes by no more than the distance travelled.
        let most = (from.1 + to.1 + long) / 2.0;
        if self.convex || long < FINE_M || most <= worst.max(TOLERANCE_M) || self.points_left.get() == 0 {
            return worst;
        }
        self.points_left.set(self.points_left.get() - 1);
        let point = (from.0 + to.0) / 2.0;
        let middle = (point, margin - enclosure_distance(self.enclosure, point));
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

    /// A U of 4 m x 2 m, with a notch 1 m wide and 1.5 m deep in its upper side.
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

    fn assert_overhang(enclosure: &Enclosure, obstacle: &Obstacle, expected: f32) {
        let overhang = EnclosureExtent::new(enclosure).overhang_m(obstacle);
        assert!((overhang - expected).abs() < 0.01, "{obstacle:?}: {overhang}, not {expected}");
    }

    #[test]
    fn a_bar_across_a_notch_is_outside_although_its_ends_are_inside() {
        let bar = Shape::Rectangle { width_m: 2.0, height_m: 0.1 };
        let still = |y| obstacle(bar.clone(), vec2(0.0, y), ObstacleMotion::Static);
        // At the centre of the notch both of its walls are 0.5 m away.
        assert_overhang(&u(), &still(0.3), 0.5);
        assert_overhang(&u(), &still(-0.4), 0.15);
        assert!(
            EnclosureExtent::new(&u()).overhang_m(&still(-0.75)) <= 0.0,
            "there is space below the notch"
        );
        let rod = Shape::Capsule { length_m: 1.8, radius_m: 0.05 };
        assert_overhang(&u(), &obstacle(rod, vec2(0.0, 0.3), ObstacleMotion::Static), 0.55);
    }

    #[test]
    fn a_patrol_with_corners_in_both_arms_crosses_the_notch() {
        let ball = Shape::Circle { radius_m: 0.2 };
        let patrol = |waypoints_m| ObstacleMotion::Patrol { waypoints_m, speed_m_s: 0.1.into() };
        assert_overhang(&u(), &obstacle(ball.clone(), vec2(-1.0, 0.3), patrol(vec![vec2(1.0, 0.3)])), 0.7);
        // Down, across below the notch, and up; but the last leg leads back through the notch.
        let around = vec![vec2(-1.0, -0.75), vec2(1.0, -0.75), vec2(1.0, 0.3)];
        assert_overhang(&u(), &obstacle(ball.clone(), vec2(-1.0, 0.3), patrol(around.clone())), 0.7);
        let back = ObstacleMotion::BackAndForth { waypoints_m: around, speed_m_s: 0.1.into() };
        assert!(
            EnclosureExtent::new(&u()).overhang_m(&obstacle(ball, vec2(-1.0, 0.3), back)) <= 0.0,
            "the path back is the same, and free"
        );
    }

    #[test]
    fn in_a_rectangle_the_corners_of_the_path_decide() {
        let square = Enclosure::Rectangle { width_m: 4.0, height_m: 4.0 };
        let ball = Shape::Circle { radius_m: 0.15 };
        let walk =
            |radius_m, speed: f32| ObstacleMotion::RandomWalk { radius_m, speed_m_s: speed.into(), seed: 1 };
        assert_overhang(&square, &obstacle(ball.clone(), vec2(1.0, 0.0), walk(0.9, 0.1)), 0.05);
        let stays =
            EnclosureExtent::new(&square).overhang_m(&obstacle(ball.clone(), vec2(1.0, 0.0), walk(0.9, 0.0)));
        assert!(stays <= 0.0, "without speed it stays in place");
        // 1 m from the centre (0.5, 0), and a radius of 0.15 m: up to x = 1.65 m, with the wall at 2 m.
        let orbit =
            |speed: f32| ObstacleMotion::Orbit { centre_m: vec2(0.5, 0.0), speed_rad_s: speed.into() };
        assert_overhang(&square, &obstacle(ball.clone(), vec2(0.5, 1.0), orbit(0.1)), -0.35);
        assert_overhang(&square, &obstacle(ball, vec2(0.5, 1.9), orbit(0.1)), 0.55);
        let corners_m = vec![vec2(0.0, -0.1), vec2(1.0, 0.0), vec2(0.0, 0.1)];
        assert_overhang(
            &square,
            &obstacle(Shape::Polygon { corners_m }, vec2(1.5, 0.0), ObstacleMotion::Static),
            0.5,
        );
    }
}
