//! Rounded convex areas: the area that an obstacle covers at rest or on a straight leg, and whether two such areas overlap.

use super::polygons::meet;
use crate::polygon::{sides, signed_distance};
use crate::schema::Obstacle;
use glam::Vec2;

/// All points within a radius of a convex polygon, a segment or a point.
#[derive(Clone, Debug)]
pub(crate) struct RoundedArea {
    /// Corners in counterclockwise order; one for a point, two for a segment.
    corners_m: Vec<Vec2>,
    radius_m: f32,
}

impl RoundedArea {
    /// The area of `obstacle` at step 0, without a rim of `rim_m`. A polygon thinner than two rims loses less, so that some of it
    /// remains.
    pub(crate) fn within(obstacle: &Obstacle, rim_m: f32) -> Self {
        let (points, radius_m) = obstacle.shape.support_points(obstacle.rotation_rad);
        let mut corners_m = convex_hull(points.iter().map(|&point| obstacle.position_m + point).collect());
        if radius_m >= rim_m {
            return Self { corners_m, radius_m: radius_m - rim_m };
        }
        let inner_m = convex_hull(without_rim(&corners_m, rim_m));
        if !inner_m.is_empty() {
            return Self { corners_m: inner_m, radius_m: 0.0 };
        }
        let middle = corners_m.iter().sum::<Vec2>() / corners_m.len() as f32;
        for corner in &mut corners_m {
            *corner += (middle - *corner).clamp_length_max(rim_m);
        }
        Self { corners_m, radius_m: 0.0 }
    }

    /// The area covered while this one moves in a straight line, from its position plus `from` to its position plus `to`.
    pub(crate) fn swept(&self, from: Vec2, to: Vec2) -> Self {
        let ends = [from, to].into_iter();
        let points = ends.flat_map(|by| self.corners_m.iter().map(move |&corner| corner + by)).collect();
        Self { corners_m: convex_hull(points), radius_m: self.radius_m }
    }

    /// The area with a rim of `rim_m` added.
    pub(crate) fn grown(&self, rim_m: f32) -> Self {
        Self { corners_m: self.corners_m.clone(), radius_m: self.radius_m + rim_m }
    }

    /// Whether the two areas have a point in common.
    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        let (one, another) = (&self.corners_m, &other.corners_m);
        corner_distance(one, another) < self.radius_m + other.radius_m || cross(one, another)
    }

    /// The point nearest to `point` on the sides of the polygon, without the radius.
    pub(super) fn boundary_point(&self, point: Vec2) -> Vec2 {
        let nearest = sides(&self.corners_m).map(|(from, to)| {
            let along = to - from;
            from + along
                * ((point - from).dot(along) / along.length_squared().max(f32::MIN_POSITIVE)).clamp(0.0, 1.0)
        });
        nearest.min_by(|a, b| a.distance(point).total_cmp(&b.distance(point))).unwrap_or(point)
    }

    /// The number of its corners.
    pub(super) fn corner_count(&self) -> usize {
        self.corners_m.len()
    }
}

/// The corners of the part of a convex polygon that is at least `rim_m` inside each of its sides; none if there is no such part.
fn without_rim(corners: &[Vec2], rim_m: f32) -> Vec<Vec2> {
    let mut kept = corners.to_vec();
    for (from, to) in sides(corners) {
        let inwards = (to - from).perp().normalize_or_zero();
        let depth = |point: Vec2| (point - from).dot(inwards) - rim_m;
        let mut clipped = Vec::new();
        for (a, b) in sides(&kept) {
            let (of_a, of_b) = (depth(a), depth(b));
            if of_a >= 0.0 {
                clipped.push(a);
            }
            if (of_a >= 0.0) != (of_b >= 0.0) {
                clipped.push(a.lerp(b, of_a / (of_a - of_b)));
            }
        }
        kept = clipped;
    }
    kept
}

/// The distance between two convex polygons, segments or points, in m; 0 where they overlap.
#[must_use]
pub fn convex_distance(one: &[Vec2], another: &[Vec2]) -> f32 {
    let distance = corner_distance(one, another);
    if distance > 0.0 && cross(one, another) { 0.0 } else { distance.max(0.0) }
}

/// The least distance from a corner of one polygon to the other, in m; negative if a corner is inside.
fn corner_distance(one: &[Vec2], another: &[Vec2]) -> f32 {
    let nearest = |corners: &[Vec2], points: &[Vec2]| {
        points.iter().map(|&point| -signed_distance(corners, point)).fold(f32::INFINITY, f32::min)
    };
    nearest(one, another).min(nearest(another, one))
}

/// Whether a side of one polygon crosses or touches a side of the other.
fn cross(one: &[Vec2], another: &[Vec2]) -> bool {
    let in_f64 = |(from, to): (Vec2, Vec2)| (from.as_dvec2(), to.as_dvec2());
    sides(one).any(|side| sides(another).any(|other| meet(in_f64(side), in_f64(other))))
}

/// The corners of the convex hull, in counterclockwise order (Andrew's monotone chain).
fn convex_hull(mut points: Vec<Vec2>) -> Vec<Vec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let mut hull = half_hull(points.iter().copied());
    let upper = half_hull(points.iter().rev().copied());
    hull.extend(upper);
    hull
}

/// The part of the hull on the right of the line from the first point to the last, without the last point.
fn half_hull(points: impl Iterator<Item = Vec2>) -> Vec<Vec2> {
    let mut hull: Vec<Vec2> = Vec::new();
    for point in points {
        while let [.., a, b] = hull[..]
            && (b - a).perp_dot(point - b) <= 0.0
        {
            hull.pop();
        }
        hull.push(point);
    }
    hull.pop();
    hull
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schema::{ObstacleMotion, Shape};
    use glam::vec2;

    fn area(shape: Shape, position_m: Vec2) -> RoundedArea {
        let motion = ObstacleMotion::Static;
        RoundedArea::within(&Obstacle { shape, position_m, rotation_rad: 0.0, motion }, 0.0)
    }

    fn circle(x: f32, y: f32) -> RoundedArea {
        area(Shape::Circle { radius_m: 0.5 }, vec2(x, y))
    }

    fn bar(width_m: f32, height_m: f32) -> RoundedArea {
        area(Shape::Rectangle { width_m, height_m }, Vec2::ZERO)
    }

    #[test]
    fn areas_overlap_if_they_have_a_point_in_common() {
        // A circle next to a side, beyond a corner, inside; bars that cross without a corner in each other.
        assert!(circle(1.4, 0.0).overlaps(&bar(2.0, 1.0)) && !circle(1.6, 0.0).overlaps(&bar(2.0, 1.0)));
        assert!(circle(1.3, 0.8).overlaps(&bar(2.0, 1.0)) && !circle(1.4, 0.9).overlaps(&bar(2.0, 1.0)));
        assert!(circle(0.1, 0.0).overlaps(&bar(8.0, 6.0)) && bar(8.0, 6.0).overlaps(&circle(0.1, 0.0)));
        assert!(bar(4.0, 0.1).overlaps(&bar(0.1, 4.0)));
        assert!(
            circle(0.0, 0.0).overlaps(&circle(0.9, 0.0)) && !circle(0.0, 0.0).overlaps(&circle(1.1, 0.0))
        );
    }

    #[test]
    fn a_moving_area_covers_all_of_its_leg_and_no_more() {
        let swept = bar(0.2, 2.0).swept(vec2(-3.0, 0.0), vec2(3.0, 0.0));
        assert_eq!(swept.corner_count(), 4, "a bar that moves sideways covers a rectangle");
        // A circle smaller than the bar, in the middle of the leg and away from the path of every corner.
        assert!(swept.overlaps(&area(Shape::Circle { radius_m: 0.05 }, vec2(1.0, 0.4))));
        assert!(circle(0.0, 1.4).overlaps(&swept) && !circle(0.0, 1.6).overlaps(&swept));
        let ball = circle(0.0, 0.0).swept(Vec2::ZERO, vec2(4.0, 4.0));
        assert!(circle(2.6, 1.4).overlaps(&ball) && !circle(3.0, 1.0).overlaps(&ball));
    }

    #[test]
    fn areas_that_only_touch_do_not_overlap_without_their_rims() {
        let wall = |x| {
            let shape = Shape::Rectangle { width_m: 1.0, height_m: 1.0 };
            let motion = ObstacleMotion::Static;
            RoundedArea::within(
                &Obstacle { shape, position_m: vec2(x, 0.0), rotation_rad: 0.0, motion },
                0.005,
            )
        };
        assert!(!wall(0.0).overlaps(&wall(1.0)) && wall(0.0).overlaps(&wall(0.98)));
        let shelf = |height_m, y| {
            let shape = Shape::Rectangle { width_m: 4.0, height_m };
            let motion = ObstacleMotion::Static;
            RoundedArea::within(
                &Obstacle { shape, position_m: vec2(0.0, y), rotation_rad: 0.0, motion },
                0.005,
            )
        };
        assert!(
            !shelf(0.2, 0.0).overlaps(&shelf(0.2, 0.195)) && shelf(0.2, 0.0).overlaps(&shelf(0.2, 0.185))
        );
        assert!(shelf(0.002, 0.0).overlaps(&shelf(0.2, 0.0)), "a shape without an inner part is not ignored");
    }
}
