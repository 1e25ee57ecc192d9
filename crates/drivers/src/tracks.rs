//! Velocities of moving obstacles, estimated from scans.
//!
//! Neighbouring hits of a scan form clusters. A compact cluster may be a moving obstacle: it is followed from scan to scan,
//! in the robot's present frame, by an alpha-beta filter with constant velocity. It counts as moving if it was seen in several
//! scans, its estimated speed is high enough, and one of its hits is where an earlier beam had passed. The last condition
//! excludes walls, which also seem to move when other beams hit them. All other hits are taken as static.
//!
//! Source of the filter: P. R. Kalata, *The tracking index*, IEEE Transactions on Aerospace and Electronic Systems
//! 20(2), 1984.

use std::ops::Range;

use glam::Vec2;

use crate::config::TrackingParameters;
use crate::dwa::MovingPoint;
use crate::free_space::FreeSpace;
use crate::percept::{Odometry, Percept};
use crate::robot::Robot;

/// A track is dropped if its object was missed in more than this many scans in a row.
const MAX_MISSED: u32 = 3;

/// The tracks of objects that may move.
pub(crate) struct Tracks {
    parameters: TrackingParameters,
    tracks: Vec<Track>,
    free_space: FreeSpace,
}

/// The track of an object that may move, in the robot's present frame.
struct Track {
    at_m: Vec2,
    velocity_m_s: Vec2,
    /// The number of scans in which the object was seen.
    seen: u32,
    /// The number of scans since the object was last seen.
    missed: u32,
}

/// Neighbouring hits of a scan.
struct Cluster {
    hits: Range<usize>,
    centre_m: Vec2,
}

impl Tracks {
    pub(crate) fn new(parameters: TrackingParameters) -> Self {
        Self { parameters, tracks: Vec::new(), free_space: FreeSpace::default() }
    }

    /// Updates the tracks with a scan. Returns its hits with their velocities.
    pub(crate) fn update(&mut self, robot: &Robot, percept: &Percept) -> Vec<MovingPoint> {
        let still = |at_m| MovingPoint { at_m, velocity_m_s: Vec2::ZERO };
        let mut points: Vec<MovingPoint> = robot.hits(percept.ranges_m).map(still).collect();
        self.start_at_gap(robot, &mut points);
        self.free_space.add(robot, percept);
        self.predict(&percept.odometry, robot.control_period_s);
        let margin_m = self.parameters.free_margin * robot.unit_m;
        let was_free = |point: &MovingPoint| self.free_space.contains(robot, point.at_m, margin_m);
        let clusters = self.clusters(robot, &points);
        let mut is_taken = vec![false; clusters.len()];
        for track in &mut self.tracks {
            let gate_m = (2.0 * robot.unit_m).max(2.0 * robot.beam_spacing_rad * track.at_m.length());
            let distance = |k: usize| (clusters[k].centre_m - track.at_m).length();
            let near = (0..clusters.len()).filter(|&k| !is_taken[k] && distance(k) <= gate_m);
            let nearest = near.reduce(|best, k| if distance(k) < distance(best) { k } else { best });
            let Some(nearest) = nearest else {
                track.missed += 1;
                continue;
            };
            is_taken[nearest] = true;
            track.correct(clusters[nearest].centre_m, &self.parameters, robot.control_period_s);
            let hits = &mut points[clusters[nearest].hits.clone()];
            if track.seen >= self.parameters.min_scans
                && track.velocity_m_s.length() >= self.parameters.min_speed_m_s
                && hits.iter().any(was_free)
            {
                for point in hits {
                    point.velocity_m_s = track.velocity_m_s;
                }
            }
        }
        self.tracks.retain(|track| track.missed <= MAX_MISSED);
        let new = clusters.iter().zip(is_taken).filter(|(_, is_taken)| !is_taken);
        self.tracks.extend(new.map(|(cluster, _)| Track {
            at_m: cluster.centre_m,
            velocity_m_s: Vec2::ZERO,
            seen: 1,
            missed: 0,
        }));
        points
    }

    /// Predicts all tracks, in the frame of the robot, which has moved by `odometry` in `seconds`.
    fn predict(&mut self, odometry: &Odometry, seconds: f32) {
        let turn = Odometry { translation_m: Vec2::ZERO, ..*odometry };
        for track in &mut self.tracks {
            track.at_m = odometry.to_inner(track.at_m + track.velocity_m_s * seconds);
            track.velocity_m_s = turn.to_inner(track.velocity_m_s);
        }
    }

    /// Whether two hits of neighbouring beams are so near each other that they belong to one cluster.
    fn is_linked(&self, robot: &Robot, one: Vec2, other: Vec2) -> bool {
        let spacing_m = robot.beam_spacing_rad * one.length().min(other.length());
        (one - other).length() <= self.parameters.link * spacing_m
    }

    /// Rotates the list of hits so that the first and the last are in different clusters, if there is a gap at all. With a full
    /// circle of beams, the first and the last are neighbours.
    fn start_at_gap(&self, robot: &Robot, points: &mut [MovingPoint]) {
        let previous = |k: usize| points[(k + points.len() - 1) % points.len()].at_m;
        let gap = (0..points.len()).find(|&k| !self.is_linked(robot, previous(k), points[k].at_m));
        points.rotate_left(gap.unwrap_or(0));
    }

    /// The compact clusters of hits.
    fn clusters(&self, robot: &Robot, points: &[MovingPoint]) -> Vec<Cluster> {
        let mut clusters = Vec::new();
        let mut start = 0;
        for end in 1..=points.len() {
            if end < points.len() && self.is_linked(robot, points[end - 1].at_m, points[end].at_m) {
                continue;
            }
            let hits = &points[start..end];
            // All hits count, not only the last: on the walls of a round room, it is next to the first.
            let from_first_m = hits.iter().map(|hit| (hit.at_m - hits[0].at_m).length());
            let extent_m = from_first_m.fold(0.0, f32::max);
            if extent_m <= self.parameters.max_extent * robot.unit_m {
                let mean = hits.iter().map(|hit| hit.at_m).sum::<Vec2>() / hits.len() as f32;
                // The scan shows only the near side. The centre of a disc lies about half its width behind it.
                let centre_m = mean + mean.normalize_or_zero() * (0.5 * extent_m);
                clusters.push(Cluster { hits: start..end, centre_m });
            }
            start = end;
        }
        clusters
    }
}

impl Track {
    /// Corrects the prediction by a measured position. A control step takes `period_s`.
    fn correct(&mut self, measured_m: Vec2, parameters: &TrackingParameters, period_s: f32) {
        let error = measured_m - self.at_m;
        let seconds = period_s * (self.missed + 1) as f32;
        self.seen += 1;
        self.missed = 0;
        if self.seen == 2 {
            (self.at_m, self.velocity_m_s) = (measured_m, error / seconds);
            return;
        }
        self.at_m += error * parameters.position_gain;
        self.velocity_m_s += error * (parameters.velocity_gain / seconds);
    }
}

#[cfg(test)]
mod tests {
    use glam::vec2;
    use wayfield_scenario::{Lidar, Motion, Scenario};

    use super::*;

    /// The range of a beam in direction `beam` from `from` to a disc with radius 0.2 m at `at`, or 3.5 m.
    fn range(beam: Vec2, from: Vec2, at: Vec2) -> f32 {
        let along = beam.dot(at - from);
        let off = beam.perp_dot(at - from);
        let half_squared = 0.2_f32 * 0.2 - off * off;
        if along > 0.0 && half_squared > 0.0 { along - half_squared.sqrt() } else { 3.5 }
    }

    /// The points in the last of `steps` scans of a robot with the motion `motion`, and their velocities, in the world frame. One
    /// disc is at `disc_m(step)`, where the robot sees it unless `is_hidden(step)`. Another one stands at (-1, -0.5).
    fn points_in_scan(
        steps: usize,
        motion: Motion,
        disc_m: impl Fn(f32) -> Vec2,
        is_hidden: impl Fn(usize) -> bool,
    ) -> Vec<(Vec2, Vec2)> {
        let scenario = Scenario { lidar: Lidar { beams: 180, ..Lidar::default() }, ..Scenario::default() };
        let robot = Robot::of(&scenario);
        let mut tracks = Tracks::new(TrackingParameters::default());
        let mut pose = Odometry::default();
        let turn = |pose: &Odometry| Odometry { translation_m: Vec2::ZERO, ..*pose };
        let mut points = Vec::new();
        for step in 0..steps {
            let odometry = if step == 0 { Odometry::default() } else { Robot::arc(&motion, 0.2) };
            pose = pose.then(&odometry);
            let range_m = |beam: &Vec2| {
                let beam = turn(&pose).to_outer(*beam);
                let still_m = range(beam, pose.translation_m, vec2(-1.0, -0.5));
                let moving_m = range(beam, pose.translation_m, disc_m(step as f32));
                if is_hidden(step) { still_m } else { still_m.min(moving_m) }
            };
            let ranges_m: Vec<f32> = robot.beams.iter().map(range_m).collect();
            let percept = Percept {
                ranges_m: &ranges_m,
                goal_distance_m: 1.0,
                goal_bearing_rad: 0.0,
                twist: motion,
                odometry,
                truth: None,
            };
            points = tracks.update(&robot, &percept);
        }
        let in_world =
            |point: &MovingPoint| (pose.to_outer(point.at_m), turn(&pose).to_outer(point.velocity_m_s));
        points.iter().map(in_world).collect()
    }

    const STILL: Motion = Motion { v_m_s: 0.0, w_rad_s: 0.0 };

    #[test]
    fn the_velocity_of_a_disc_is_estimated_while_the_robot_drives_and_turns() {
        let motion = Motion { v_m_s: 0.15, w_rad_s: 0.75 };
        let points = points_in_scan(15, motion, |step| vec2(1.5, 0.6 - 0.04 * step), |_| false);
        let (moving, still): (Vec<_>, Vec<_>) = points.iter().partition(|(at, _)| at.x > 0.0);
        assert!(moving.len() >= 4 && still.len() >= 4, "both are seen: {points:?}");
        for (_, velocity) in moving {
            assert!((velocity - vec2(0.0, -0.2)).length() < 0.07, "{velocity}");
        }
        for (_, velocity) in still {
            assert!(velocity.length() < 0.07, "{velocity}");
        }
    }

    #[test]
    fn a_disc_dead_ahead_is_one_cluster() {
        // It crosses the robot's axis, where the first and the last beam are neighbours.
        let points = points_in_scan(15, STILL, |step| vec2(1.5, 0.52 - 0.04 * step), |_| false);
        let moving: Vec<_> = points.iter().filter(|(at, _)| at.x > 0.0 && at.y.abs() < 0.1).collect();
        let on_the_left = moving.iter().filter(|(at, _)| at.y > 0.0).count();
        assert!(on_the_left >= 2 && moving.len() - on_the_left >= 2, "{moving:?}");
        for (_, velocity) in moving {
            assert!((velocity - vec2(0.0, -0.2)).length() < 0.07, "{velocity}");
        }
    }

    #[test]
    fn the_walls_of_a_round_room_are_no_compact_cluster() {
        let scenario = Scenario { lidar: Lidar { beams: 180, ..Lidar::default() }, ..Scenario::default() };
        let robot = Robot::of(&scenario);
        let hit = |beam: &Vec2| MovingPoint { at_m: *beam * 1.5, velocity_m_s: Vec2::ZERO };
        let points: Vec<MovingPoint> = robot.beams.iter().map(hit).collect();
        let tracks = Tracks::new(TrackingParameters::default());
        assert_eq!(tracks.clusters(&robot, &points).len(), 0);
        assert_eq!(tracks.clusters(&robot, &points[..8]).len(), 1, "a few of the hits are");
    }

    #[test]
    fn the_steps_in_which_a_disc_is_hidden_count_in_its_velocity() {
        // It is seen in step 0 and from step 3 on. After four scans, it counts as moving.
        let disc_m = |step| vec2(1.5, 0.6 - 0.04 * step);
        let points = points_in_scan(6, STILL, disc_m, |step| (1..=2).contains(&step));
        let moving: Vec<_> = points.iter().filter(|(at, _)| at.x > 0.0).collect();
        assert!(!moving.is_empty());
        for (_, velocity) in moving {
            assert!((velocity - vec2(0.0, -0.2)).length() < 0.07, "{velocity}");
        }
    }
}
