//! The area that an obstacle covers on its whole path, and where on the path it meets something.

use super::convex::RoundedArea;
use crate::geometry::shape_distance;
use crate::schema::Obstacle;
use crate::track::Track;
use glam::Vec2;

/// Width of the rim that may overlap, in m: obstacles placed against a wall do not count as overlapping.
const RIM_M: f32 = 0.0025;
/// Number of intervals into which a leg, or a whole circle, is divided to locate an overlap.
const SAMPLES: u16 = 64;

/// A solid that does not move: a static obstacle, or a segment of a wall.
pub(super) struct StaticSolid {
    obstacle: Obstacle,
    area: RoundedArea,
}

impl StaticSolid {
    pub(super) fn new(obstacle: Obstacle) -> Self {
        Self { area: RoundedArea::within(&obstacle, RIM_M), obstacle }
    }
}

/// The area that an obstacle covers on its whole path.
pub(super) struct SweptPath<'a> {
    obstacle: &'a Obstacle,
    area: Area,
    /// The centre of a circle around the area.
    middle_m: Vec2,
    /// The radius of that circle.
    reach_m: f32,
}

enum Area {
    /// One area per leg; a single one for an obstacle that does not move, or that walks at random.
    Legs(Vec<RoundedArea>),
    /// All points between two distances from the middle.
    Ring { near_m: f32, far_m: f32 },
}

impl<'a> SweptPath<'a> {
    pub(super) fn of(obstacle: &'a Obstacle) -> Self {
        let area = RoundedArea::within(obstacle, RIM_M);
        let (at, around) = (obstacle.position_m, obstacle.shape.bounding_radius_m());
        let legs = |areas, reach_m| Self { obstacle, area: Area::Legs(areas), middle_m: at, reach_m };
        match obstacle.actual_track() {
            Track::Point => legs(vec![area], around),
            Track::Circle { centre_m } => {
                let far_m = obstacle.max_distance_from(centre_m) - RIM_M;
                let near_m = distance(obstacle, centre_m).max(0.0) + RIM_M;
                Self { obstacle, area: Area::Ring { near_m, far_m }, middle_m: centre_m, reach_m: far_m }
            }
            Track::Disc { radius_m } => legs(vec![area.grown(radius_m)], around + radius_m),
            Track::Lines { corners_m, closed } => {
                let stops = stops(corners_m, closed);
                let reach_m = stops.iter().map(|stop| stop.distance(at)).fold(0.0, f32::max) + around;
                let swept = |ends: &[Vec2]| area.swept(ends[0] - at, ends[1] - at);
                legs(stops.windows(2).map(swept).collect(), reach_m)
            }
        }
    }

    /// Whether the circle around this area and the one around `solid` are apart, so that the two can't overlap.
    fn is_far_from(&self, solid: &StaticSolid) -> bool {
        let reach_m = self.reach_m + solid.obstacle.shape.bounding_radius_m();
        solid.obstacle.position_m.distance(self.middle_m) > reach_m
    }

    /// The work of [`overlaps`](Self::overlaps), in pairs of sides; at least 1.
    pub(super) fn work(&self, solid: &StaticSolid) -> usize {
        match &self.area {
            Area::Legs(areas) if !self.is_far_from(solid) => {
                let corners: usize = areas.iter().map(RoundedArea::corner_count).sum();
                1 + corners * solid.area.corner_count()
            }
            _ => 1,
        }
    }

    /// Whether the obstacle overlaps `solid` somewhere on its path. A random walk may take a long time to get there.
    pub(super) fn overlaps(&self, solid: &StaticSolid) -> bool {
        if self.is_far_from(solid) {
            return false;
        }
        match &self.area {
            Area::Legs(areas) => areas.iter().any(|area| area.overlaps(&solid.area)),
            Area::Ring { near_m, far_m } => {
                let centre_m = self.middle_m;
                distance(&solid.obstacle, centre_m) < *far_m
                    && solid.obstacle.max_distance_from(centre_m) > *near_m
            }
        }
    }

    /// A point near the deepest point of the overlap with `solid`, in m; for an obstacle on a path or an orbit, a point of its
    /// track.
    pub(super) fn position_m(&self, solid: &StaticSolid) -> Vec2 {
        let samples = || (0..=SAMPLES).map(|k| f32::from(k) / f32::from(SAMPLES));
        let at = self.obstacle.position_m;
        let points: Vec<Vec2> = match self.obstacle.actual_track() {
            Track::Circle { centre_m } => {
                let rotated = |fraction: f32| {
                    let (sin, cos) = libm::sincosf(fraction * std::f32::consts::TAU);
                    centre_m + Vec2::new(cos, sin).rotate(at - centre_m)
                };
                samples().map(rotated).collect()
            }
            Track::Lines { corners_m, closed } => {
                let stops = stops(corners_m, closed);
                let leg = |ends: &[Vec2]| -> Vec<Vec2> {
                    samples().map(|fraction| ends[0].lerp(ends[1], fraction)).collect()
                };
                stops.windows(2).flat_map(leg).collect()
            }
            Track::Point | Track::Disc { .. } => {
                let nearest = solid.area.boundary_point(at);
                samples().map(|fraction| at.lerp(nearest, fraction)).collect()
            }
        };
        // The signed distance to the overlap, least at the deepest point; for a moving obstacle, the distance to the solid.
        let is_moving = self.obstacle.motion.is_moving();
        let own = |point| if is_moving { f32::NEG_INFINITY } else { distance(self.obstacle, point) };
        let from_overlap = |point: &Vec2| distance(&solid.obstacle, *point).max(own(*point));
        points.into_iter().min_by(|a, b| from_overlap(a).total_cmp(&from_overlap(b))).unwrap_or(at)
    }
}

/// The corners of a path, and the first again at the end of a closed one.
fn stops(mut corners_m: Vec<Vec2>, closed: bool) -> Vec<Vec2> {
    corners_m.extend(corners_m.first().copied().filter(|_| closed));
    corners_m
}

/// Signed distance of a point from an obstacle at step 0, in m.
fn distance(obstacle: &Obstacle, point: Vec2) -> f32 {
    let Vec2 { x, y } = obstacle.position_m;
    shape_distance(&obstacle.shape, (x, y, obstacle.rotation_rad), point)
}
