//! Moving objects, found by comparing scans.
//!
//! A *cluster* is a compact group of neighbouring hits. A cluster at a place where an earlier scan saw nothing has moved.
//! It is followed back in time: in each earlier scan, to the cluster nearest to the position where it is expected. Its
//! velocity is the slope of the line fitted to its positions. Everything else is taken to be static. With few beams,
//! only near objects are found in time.
//!
//! Lengths are in units of the robot, which `sectors.rs` defines.

use serde::{Deserialize, Serialize};

/// The number of control steps that a cluster is followed back.
pub(super) const FOLLOWED_STEPS: usize = 5;
/// The minimum number of positions for a velocity.
const MIN_POSITIONS: usize = 3;
/// Neighbouring hits belong to one cluster if their distance is at most this many times the distance between beams at
/// that range.
const LINK: f32 = 2.0;
/// Neighbouring hits also belong to one cluster if their distance is at most this, in units of the robot.
const MIN_LINK: f32 = 0.5;
/// The largest extent of a cluster that may move, in units of the robot. Larger clusters are taken for walls.
const MAX_EXTENT: f32 = 5.0;
/// The distance, in units of the robot, that a cluster in a scan may always have from its expected position, even if the robot
/// is slow.
const MIN_GATE: f32 = 1.0;
/// The minimum displacement over all positions that counts as motion, in units of the robot.
const MIN_DISPLACEMENT: f32 = 0.3;

/// A compact group of hits in a scan: a disc in the robot's frame at the time of the scan, in units of the robot.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Cluster {
    pub(super) x: f32,
    pub(super) y: f32,
    pub(super) radius: f32,
}

impl Cluster {
    /// Whether its numbers are in range.
    pub(super) fn is_valid(&self) -> bool {
        let in_reach = |value: f32| value.is_finite() && value.abs() < 1e6;
        in_reach(self.x) && in_reach(self.y) && (0.0..1e6).contains(&self.radius)
    }
}

/// The end of a beam that has hit something, in units of the robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BeamEnd {
    pub(super) x: f32,
    pub(super) y: f32,
    pub(super) distance: f32,
}

impl BeamEnd {
    fn distance_to(self, other: Self) -> f32 {
        length(self.x - other.x, self.y - other.y)
    }
}

/// A moving cluster in the robot's present frame: its disc, and its displacement in a control step, in units of the robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MovingCluster {
    disc: Cluster,
    velocity: (f32, f32),
}

impl MovingCluster {
    /// The number of control steps until the robot collides with the cluster if it moves from the origin by `step` in each of
    /// them; infinite if they do not collide. Without branches, so that a loop over many steps is vectorized.
    #[inline(always)]
    pub(super) fn steps_to_collision(&self, step: (f32, f32)) -> f32 {
        let Self { disc, velocity } = self;
        let relative = (step.0 - velocity.0, step.1 - velocity.1);
        let speed_2 = relative.0 * relative.0 + relative.1 * relative.1;
        let along = disc.x * relative.0 + disc.y * relative.1;
        let reach = 1.0 + disc.radius;
        let apart_2 = disc.x * disc.x + disc.y * disc.y - reach * reach;
        let root_2 = along * along - speed_2 * apart_2;
        let steps = if apart_2 <= 0.0 { 0.0 } else { (along - root_2.sqrt()) / speed_2 };
        let collide = (along > 0.0) & (speed_2 > 1e-9) & (root_2 > 0.0);
        if collide { steps } else { f32::INFINITY }
    }
}

fn length(x: f32, y: f32) -> f32 {
    (x * x + y * y).sqrt()
}

/// Finds the clusters in a scan, and for each beam the index of the cluster that it has hit, if any. `ends` are the ends of the
/// beams, in the order of the beams.
pub(super) fn find_clusters(
    ends: &[Option<BeamEnd>],
    spacing_rad: f32,
    cluster_of_beam: &mut Vec<Option<u16>>,
    clusters: &mut Vec<Cluster>,
) {
    let beams = ends.len();
    clusters.clear();
    cluster_of_beam.clear();
    cluster_of_beam.resize(beams, None);
    let is_linked = |one: usize, other: usize| match (ends[one], ends[other]) {
        (Some(one), Some(other)) => {
            let between_beams = spacing_rad * one.distance.min(other.distance);
            one.distance_to(other) <= (LINK * between_beams).max(MIN_LINK)
        }
        _ => false,
    };
    // A LIDAR with a field of view of 360 degrees may see one cluster with its first and last beams.
    let is_first = |beam: usize| !is_linked(beam.checked_sub(1).unwrap_or(beams - 1), beam);
    let Some(first) = (0..beams).find(|&beam| is_first(beam)) else { return };
    let at = |index: usize| if first + index < beams { first + index } else { first + index - beams };
    let mut start = 0;
    for end in 1..=beams {
        if end < beams && is_linked(at(end - 1), at(end)) {
            continue;
        }
        let hits = || (start..end).filter_map(|index| ends[at(index)]);
        if let (Some(one), Some(other)) = (hits().next(), hits().next_back()) {
            let extent = one.distance_to(other);
            if extent <= MAX_EXTENT && clusters.len() < usize::from(u16::MAX) {
                let count = (end - start) as f32;
                let (x, y) =
                    hits().fold((0.0, 0.0), |sum, hit| (sum.0 + hit.x / count, sum.1 + hit.y / count));
                // The scan shows only the near side. The centre of a disc lies about half its width behind it.
                let behind = 1.0 + 0.5 * extent / length(x, y).max(0.1);
                (start..end).for_each(|index| cluster_of_beam[at(index)] = Some(clusters.len() as u16));
                clusters.push(Cluster { x: x * behind, y: y * behind, radius: 0.5 * extent });
            }
        }
        start = end;
    }
}

/// The robot's frame at an earlier scan: its rotation and its origin in the present frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    cos: f32,
    sin: f32,
    origin: (f32, f32),
}

impl Frame {
    /// The robot's frame at the pose `then`, relative to its frame at the pose `now`, in units of `unit_m`. Poses are x
    /// in m, y in m and heading in rad.
    pub(super) fn between(then: (f32, f32, f32), now: (f32, f32, f32), unit_m: f32) -> Self {
        let (sin, cos) = libm::sincosf(now.2);
        let (dx, dy) = (then.0 - now.0, then.1 - now.1);
        let origin = ((dx * cos + dy * sin) / unit_m, (dy * cos - dx * sin) / unit_m);
        let (sin, cos) = libm::sincosf(then.2 - now.2);
        Self { cos, sin, origin }
    }

    /// Converts a point of this frame to the present frame.
    pub(super) fn to_present(self, (x, y): (f32, f32)) -> (f32, f32) {
        let Self { cos, sin, origin } = self;
        (x * cos - y * sin + origin.0, x * sin + y * cos + origin.1)
    }
}

/// Follows a cluster of the present scan back through the `earlier` scans, the newest first, and returns it if it moves.
/// In each scan it may be up to `gate` (at least [`MIN_GATE`]) away from its expected position, in units of the robot.
pub(super) fn follow<'a>(
    disc: Cluster,
    earlier: impl Iterator<Item = (Frame, &'a [Cluster])>,
    gate: f32,
) -> Option<MovingCluster> {
    let gate = gate.max(MIN_GATE);
    let (mut at, mut velocity) = ((disc.x, disc.y), (0.0, 0.0));
    // The sums of the least-squares fit of positions over times, with the present at time 0.
    let mut positions = 1.0;
    let (mut t_sum, mut tt_sum) = (0.0, 0.0);
    let (mut sum, mut t_at_sum) = (at, (0.0, 0.0));
    for (step, (frame, clusters)) in earlier.enumerate() {
        let expected = (at.0 - velocity.0, at.1 - velocity.1);
        let candidates = clusters.iter().map(|cluster| {
            let position = frame.to_present((cluster.x, cluster.y));
            (length(position.0 - expected.0, position.1 - expected.1), position)
        });
        let nearest = candidates.filter(|(away, _)| *away <= gate).min_by(|a, b| a.0.total_cmp(&b.0));
        let Some((_, position)) = nearest else { break };
        at = position;
        let t = -((step + 1) as f32);
        positions += 1.0;
        t_sum += t;
        tt_sum += t * t;
        sum = (sum.0 + at.0, sum.1 + at.1);
        t_at_sum = (t_at_sum.0 + t * at.0, t_at_sum.1 + t * at.1);
        let determinant = positions * tt_sum - t_sum * t_sum;
        let slope = |sum: f32, t_at_sum: f32| (positions * t_at_sum - t_sum * sum) / determinant;
        velocity = (slope(sum.0, t_at_sum.0), slope(sum.1, t_at_sum.1));
    }
    let displacement = length(velocity.0, velocity.1) * (positions - 1.0);
    let moves = positions >= MIN_POSITIONS as f32 && displacement >= MIN_DISPLACEMENT;
    moves.then_some(MovingCluster { disc, velocity })
}

#[cfg(test)]
mod tests {
    use super::*;

    const PRESENT: Frame = Frame { cos: 1.0, sin: 0.0, origin: (0.0, 0.0) };

    fn disc(x: f32, y: f32) -> Cluster {
        Cluster { x, y, radius: 0.5 }
    }

    #[test]
    fn a_cluster_is_followed_to_its_velocity() {
        let scans: Vec<Vec<Cluster>> =
            (1..=5).map(|k| vec![disc(4.0, 3.0), disc(2.0 + 0.2 * k as f32, 0.0)]).collect();
        let earlier = || scans.iter().map(|clusters| (PRESENT, clusters.as_slice()));
        let moving = follow(disc(2.0, 0.0), earlier(), 0.0).expect("it moves");
        assert!((moving.velocity.0 + 0.2).abs() < 1e-5 && moving.velocity.1.abs() < 1e-5, "{moving:?}");
        assert_eq!(follow(disc(4.0, 3.0), earlier(), 0.0), None, "it is static");
        assert_eq!(follow(disc(2.0, 0.0), earlier().take(1), 0.0), None, "two positions are too few");
        assert_eq!(follow(disc(-3.0, 0.0), earlier(), 0.0), None, "it was not seen before");
    }

    #[test]
    fn points_of_an_earlier_frame_are_converted_to_the_present_one() {
        // The robot has moved ahead by 0.3 and turned left by a right angle: it sees ahead what was to its left.
        let frame = Frame { cos: 0.0, sin: -1.0, origin: (0.0, 0.3) };
        let point = frame.to_present((0.3, 2.0));
        assert!((point.0 - 2.0).abs() < 1e-6 && point.1.abs() < 1e-6, "{point:?}");
    }

    #[test]
    fn steps_to_a_collision_match_a_calculation_by_hand() {
        // A cluster 6 units ahead comes nearer by 0.5 a step; contact is at 1 + 0.5 units.
        let moving = MovingCluster { disc: disc(6.0, 0.0), velocity: (-0.5, 0.0) };
        assert_eq!(moving.steps_to_collision((0.0, 0.0)), 4.5 / 0.5);
        assert_eq!(moving.steps_to_collision((1.0, 0.0)), 4.5 / 1.5);
        assert_eq!(moving.steps_to_collision((-0.5, 0.0)), f32::INFINITY, "it never catches up");
        assert_eq!(moving.steps_to_collision((0.0, 1.0)), f32::INFINITY, "the robot is out of its way");
        let touching = MovingCluster { disc: disc(1.4, 0.0), velocity: (-0.5, 0.0) };
        assert_eq!(touching.steps_to_collision((0.0, 0.0)), 0.0);
    }

    #[test]
    fn compact_clusters_are_distinguished_from_walls_even_across_the_first_beam() {
        let beams = 36;
        let spacing_rad = std::f32::consts::TAU / beams as f32;
        let end = |beam: usize| {
            let (sin, cos) = (beam as f32 * spacing_rad).sin_cos();
            let distance = match beam {
                35 | 0 | 1 => 3.0,
                // A wall along y = 6, 7 units long.
                6..=12 => 6.0 / sin,
                20 => 2.0,
                _ => return None,
            };
            Some(BeamEnd { x: cos * distance, y: sin * distance, distance })
        };
        let ends: Vec<Option<BeamEnd>> = (0..beams).map(end).collect();
        let (mut of_beam, mut clusters) = (Vec::new(), Vec::new());
        find_clusters(&ends, spacing_rad, &mut of_beam, &mut clusters);
        assert_eq!(clusters.len(), 2, "{clusters:?}");
        let ahead = of_beam[0].expect("a cluster is ahead");
        assert_eq!((of_beam[35], of_beam[1]), (Some(ahead), Some(ahead)));
        assert!(clusters[usize::from(ahead)].y.abs() < 1e-5, "{clusters:?}");
        assert!(of_beam[6..=12].iter().all(Option::is_none), "the wall is {of_beam:?}");
        assert!(of_beam[20].is_some_and(|behind| behind != ahead), "{of_beam:?}");
    }
}
