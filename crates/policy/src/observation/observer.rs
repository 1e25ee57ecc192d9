//! The observer: turns scans and odometry into observations by sectors.
//!
//! In: per control step, a scan, the robot's pose by odometry and its motion; the goal. Out: a row with the columns of a
//! [`SectorLayout`]. The observer remembers the scans of the last steps, and allocates no memory after its first steps.

use std::collections::VecDeque;
use std::f32::consts::TAU;

use serde::{Deserialize, Serialize};

use super::moving::{BeamEnd, Cluster, FOLLOWED_STEPS, Frame, MovingCluster, find_clusters, follow};
use super::sectors::{
    BodyScale, LidarBeams, OTHER_COLUMNS, SectorLayout, distance_at, nearness, sectors_of_beams,
};

/// The factor that the change of nearness is multiplied by.
const CHANGE_GAIN: f32 = 4.0;
/// A cluster has appeared if it is nearer by more than this than what was in its direction before, in units of the robot.
const MIN_APPEARANCE: f32 = 0.25;
/// The distance beyond which hits are too far away for their motion to matter, in units of the robot.
const MOTION_RANGE: f32 = distance_at(0.12);

/// What a robot senses at one moment, besides its goal.
#[derive(Clone, Copy, Debug)]
pub struct Sensed<'a> {
    /// The reported ranges, in m, one per beam.
    pub ranges_m: &'a [f32],
    /// The robot's pose by odometry, in any fixed frame: x in m, y in m, heading in rad.
    pub pose: (f32, f32, f32),
    /// The robot's speed in m/s and turning rate in rad/s.
    pub twist: (f32, f32),
}

/// The nearest point of a sector in a scan, in the robot's frame at that moment.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Hit {
    /// Position, in units of the robot.
    x: f32,
    y: f32,
    /// Distance from the robot's centre, in units of the robot.
    distance: f32,
    /// Nearness.
    nearness: f32,
    /// The index in [`EarlierScan::clusters`] of the cluster that it belongs to.
    #[serde(rename = "thing")]
    cluster: Option<u16>,
}

const NO_HIT: Hit = Hit { x: 0.0, y: 0.0, distance: f32::INFINITY, nearness: 0.0, cluster: None };

/// A scan of an earlier step, as an observer remembers it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EarlierScan {
    pose: (f32, f32, f32),
    hits: Vec<Hit>,
    /// The clusters; empty without predicted paths.
    #[serde(rename = "things")]
    clusters: Vec<Cluster>,
}

impl EarlierScan {
    /// Whether an observer with this layout can remember the scan.
    #[must_use]
    pub fn fits(&self, layout: SectorLayout) -> bool {
        let is_hit = |hit: &Hit| {
            hit.x.is_finite()
                && hit.y.is_finite()
                && hit.distance >= 0.0
                && (0.0..=1.0).contains(&hit.nearness)
                && hit.cluster.is_none_or(|cluster| usize::from(cluster) < self.clusters.len())
        };
        let (x, y, heading) = self.pose;
        let is_pose = x.is_finite() && y.is_finite() && heading.is_finite();
        let are_clusters = self.clusters.iter().all(Cluster::is_valid);
        is_pose
            && are_clusters
            && self.hits.len() == usize::from(layout.count)
            && self.hits.iter().all(is_hit)
    }

    /// The nearest hit of each sector that a beam sees.
    fn seen<'a>(&'a self, is_seen: &'a [bool]) -> impl Iterator<Item = (usize, &'a Hit)> {
        self.hits.iter().enumerate().filter(|(sector, _)| is_seen[*sector])
    }
}

/// Encodes the observations of one robot.
#[derive(Clone, Debug, PartialEq)]
pub struct SectorObserver {
    layout: SectorLayout,
    body: BodyScale,
    beams: Vec<Beam>,
    /// For each sector, whether a beam belongs to it.
    is_seen: Vec<bool>,
    max_range_m: f32,
    spacing_rad: f32,
    /// The scans of the last steps, the newest last: at most [`steps_back`](Self::steps_back) + 1.
    scans: VecDeque<EarlierScan>,
    /// The nearness of the earlier scan's points in each sector of the present frame; negative where there is none.
    earlier: Vec<f32>,
    /// How far the robot can drive in the direction of each sector's centre, in units of the robot; infinite if nothing is in sight.
    free: Vec<f32>,
    /// The nearness of a collision in the direction of each sector's centre; empty without free paths.
    collisions: Vec<f32>,
    /// Like `collisions`, if what moves keeps moving; empty without predicted paths.
    predicted: Vec<f32>,
    /// The nearness of a collision if the robot waits.
    waiting: f32,
    /// For each cluster of the newest scan, its motion; `None` if it is still.
    moving: Vec<Option<MovingCluster>>,
    /// The frames of the scans before the newest one, the newest first.
    frames: Vec<Frame>,
    /// The ends of the newest scan's beams, and their clusters.
    ends: Vec<Option<BeamEnd>>,
    cluster_of_beam: Vec<Option<u16>>,
    /// The directions of the sectors' centres.
    directions: Directions,
    twist: (f32, f32),
}

/// Sines and cosines of directions.
type Directions = (Vec<f32>, Vec<f32>);

#[derive(Clone, Debug, PartialEq)]
struct Beam {
    cos: f32,
    sin: f32,
    extent: f32,
    sectors: Vec<usize>,
}

impl SectorObserver {
    /// An observer of a robot with this LIDAR and body, which has sensed nothing yet.
    ///
    /// # Panics
    /// The body does not have one extent per beam.
    #[must_use]
    pub fn new(layout: SectorLayout, lidar: &LidarBeams, body: BodyScale) -> Self {
        assert_eq!(lidar.angles_rad.len(), body.extents_m.len(), "one extent per beam");
        let sectors = sectors_of_beams(layout, lidar);
        let count = usize::from(layout.count);
        let mut is_seen = vec![false; count];
        sectors.iter().flatten().for_each(|&sector| is_seen[sector] = true);
        let beam = |((angle, extent_m), sectors): ((&f32, &f32), Vec<usize>)| Beam {
            cos: libm::cosf(*angle),
            sin: libm::sinf(*angle),
            extent: extent_m / body.unit_m,
            sectors,
        };
        let beams = lidar.angles_rad.iter().zip(&body.extents_m).zip(sectors).map(beam).collect();
        Self {
            layout,
            body,
            beams,
            is_seen,
            max_range_m: lidar.max_range_m,
            spacing_rad: lidar.spacing_rad,
            scans: VecDeque::new(),
            earlier: vec![-1.0; count],
            free: vec![f32::INFINITY; count],
            collisions: vec![0.0; if layout.free_paths { count } else { 0 }],
            predicted: vec![0.0; if layout.predicted_paths { count } else { 0 }],
            waiting: 0.0,
            moving: Vec::new(),
            frames: Vec::new(),
            ends: Vec::new(),
            cluster_of_beam: Vec::new(),
            directions: (0..count).map(|sector| libm::sincosf(layout.angle_rad(sector))).unzip(),
            twist: (0.0, 0.0),
        }
    }

    /// The layout of its observations.
    #[must_use]
    pub fn layout(&self) -> SectorLayout {
        self.layout
    }

    /// Forgets all scans, as at the start of an episode.
    pub fn reset(&mut self) {
        self.scans.clear();
        self.earlier.fill(-1.0);
        self.twist = (0.0, 0.0);
    }

    /// The scans that it remembers, oldest first.
    pub fn scans(&self) -> impl Iterator<Item = &EarlierScan> {
        self.scans.iter()
    }

    /// Replaces what it remembers by `scans`, which [fit](EarlierScan::fits) its layout, and `twist`, the robot's speed in m/s
    /// and turning rate in rad/s.
    pub fn restore(&mut self, scans: &[EarlierScan], twist: (f32, f32)) {
        self.reset();
        self.scans.extend(scans.iter().cloned());
        self.twist = twist;
        self.compare();
    }

    /// Takes in what the robot senses after a control step, or at the start of an episode.
    ///
    /// # Panics
    /// The number of ranges is not that of the LIDAR's beams.
    pub fn sense(&mut self, sensed: &Sensed) {
        self.twist = sensed.twist;
        let mut scan = if self.scans.len() > self.steps_back() { self.scans.pop_front() } else { None }
            .unwrap_or_else(|| EarlierScan { pose: sensed.pose, hits: Vec::new(), clusters: Vec::new() });
        scan.pose = sensed.pose;
        self.pool(sensed.ranges_m, &mut scan);
        self.scans.push_back(scan);
        self.compare();
    }

    /// The number of control steps that the observer looks back.
    fn steps_back(&self) -> usize {
        let followed = if self.layout.predicted_paths { FOLLOWED_STEPS } else { 0 };
        followed.max(usize::from(self.layout.earlier_steps))
    }

    /// Finds motion and collisions from the newest scan and those before it.
    fn compare(&mut self) {
        if self.layout.earlier_steps > 0 {
            self.move_earlier_scan();
        }
        if self.layout.predicted_paths {
            self.find_moving_clusters();
        }
        self.find_free_distances();
        if self.layout.predicted_paths {
            self.predict_collisions();
        }
    }

    /// Finds the nearest hit in each sector, and the clusters.
    fn pool(&mut self, ranges_m: &[f32], scan: &mut EarlierScan) {
        assert_eq!(ranges_m.len(), self.beams.len(), "one range per beam");
        if self.layout.predicted_paths {
            let Self { beams, body, max_range_m, ends, .. } = &mut *self;
            let end = |(beam, &range_m): (&Beam, &f32)| {
                let distance = range_m / body.unit_m;
                let is_hit = range_m < *max_range_m;
                is_hit.then_some(BeamEnd { x: beam.cos * distance, y: beam.sin * distance, distance })
            };
            ends.clear();
            ends.extend(beams.iter().zip(ranges_m).map(end));
            find_clusters(&self.ends, self.spacing_rad, &mut self.cluster_of_beam, &mut scan.clusters);
        }
        let hits = &mut scan.hits;
        let count = usize::from(self.layout.count);
        hits.clear();
        hits.resize(count, NO_HIT);
        let per_unit = 1.0 / self.body.unit_m;
        for (index, (beam, &range_m)) in self.beams.iter().zip(ranges_m).enumerate() {
            if range_m >= self.max_range_m {
                continue;
            }
            let distance = range_m * per_unit;
            let nearness = nearness(distance - beam.extent);
            let cluster = self.cluster_of_beam.get(index).copied().flatten();
            let hit = Hit { x: beam.cos * distance, y: beam.sin * distance, distance, nearness, cluster };
            for &sector in &beam.sectors {
                let sector = &mut hits[sector];
                if nearness > sector.nearness {
                    *sector = hit;
                }
            }
        }
    }

    /// Finds how far a disc with a radius of one unit can drive in the direction of each sector's centre before it collides with
    /// what is in sight, and with what of it does not move.
    fn find_free_distances(&mut self) {
        let Self { scans, moving, free, collisions, predicted, directions, .. } = self;
        let Some(EarlierScan { hits, .. }) = scans.back() else { return };
        let motion = |hit: &Hit| hit.cluster.and_then(|cluster| moving.get(usize::from(cluster)));
        let moves = |hit: &Hit| motion(hit).is_some_and(Option::is_some);
        free.fill(f32::INFINITY);
        shorten_paths(hits.iter().filter(|hit| !moves(hit)), directions, free);
        if !predicted.is_empty() {
            predicted.copy_from_slice(free);
        }
        if moving.iter().any(Option::is_some) {
            shorten_paths(hits.iter().filter(|hit| moves(hit)), directions, free);
        }
        collisions.iter_mut().zip(&*free).for_each(|(value, &free)| *value = collision_nearness(free));
    }

    /// Finds which clusters of the newest scan move.
    fn find_moving_clusters(&mut self) {
        let Self { scans, moving, earlier, body, spacing_rad, frames, .. } = self;
        moving.clear();
        let Some(now) = scans.back() else { return };
        let before = || scans.iter().rev().skip(1).take(FOLLOWED_STEPS);
        frames.clear();
        frames.extend(before().map(|scan| Frame::between(scan.pose, now.pose, body.unit_m)));
        let step = body.step_length();
        for (index, &cluster) in now.clusters.iter().enumerate() {
            // The cluster is where the earlier scan saw nothing, or something farther away.
            let has_appeared = |(hit, &earlier): (&Hit, &f32)| {
                if hit.cluster != Some(index as u16) || earlier < 0.0 {
                    return false;
                }
                let extent = hit.distance - distance_at(hit.nearness);
                let before = if earlier > 0.0 { distance_at(earlier) + extent } else { f32::INFINITY };
                before > hit.distance + MIN_APPEARANCE
            };
            if !now.hits.iter().zip(&*earlier).any(has_appeared) {
                moving.push(None);
                continue;
            }
            let earlier_clusters = frames.iter().copied().zip(before().map(|scan| scan.clusters.as_slice()));
            let distance = (cluster.x * cluster.x + cluster.y * cluster.y).sqrt();
            moving.push(follow(cluster, earlier_clusters, (2.0 * step).max(*spacing_rad * distance)));
        }
    }

    /// Finds the nearness of collisions if what moves keeps moving: in the direction of each sector's centre at the robot's
    /// highest speed, and if it waits.
    fn predict_collisions(&mut self) {
        let Self { moving, predicted, collisions, directions, body, .. } = self;
        if moving.iter().all(Option::is_none) && collisions.len() == predicted.len() {
            predicted.copy_from_slice(collisions);
            self.waiting = 0.0;
            return;
        }
        self.waiting = f32::INFINITY;
        // In control steps, then in units of the robot.
        let step = body.step_length();
        predicted.iter_mut().for_each(|free| *free /= step);
        for cluster in moving.iter().flatten() {
            for ((free, sin), cos) in predicted.iter_mut().zip(&directions.0).zip(&directions.1) {
                let steps = cluster.steps_to_collision((step * cos, step * sin));
                *free = if steps < *free { steps } else { *free };
            }
            self.waiting = self.waiting.min(cluster.steps_to_collision((0.0, 0.0)));
        }
        predicted.iter_mut().for_each(|free| *free = collision_nearness(step * *free));
        self.waiting = collision_nearness(step * self.waiting);
    }

    /// Moves the points of the earlier scan into the present frame, by odometry.
    fn move_earlier_scan(&mut self) {
        let Self { layout, scans, earlier, body, is_seen, .. } = self;
        earlier.fill(-1.0);
        let newest = scans.len().saturating_sub(1);
        let oldest = newest.saturating_sub(usize::from(layout.earlier_steps));
        if oldest == newest {
            return;
        }
        let (before, now) = (&scans[oldest], &scans[newest]);
        let count = i32::from(layout.count);
        let per_sector = TAU / f32::from(layout.count);
        let frame = Frame::between(before.pose, now.pose, body.unit_m);
        let rotation_rad = before.pose.2 - now.pose.2;
        for (sector, hit) in before.seen(is_seen) {
            let mut mark = |first: i32, last: i32, nearness: f32| {
                for sector in first..=last.min(first + count - 1) {
                    let value = &mut earlier[sector.rem_euclid(count) as usize];
                    *value = value.max(nearness);
                }
            };
            if hit.distance >= MOTION_RANGE {
                // The point is far away: it stays in the same direction, however far the robot has driven.
                let sector = (sector as f32 + rotation_rad / per_sector).round() as i32;
                mark(sector, sector, hit.nearness);
                continue;
            }
            let (x, y) = frame.to_present((hit.x, hit.y));
            let distance = (x * x + y * y).sqrt();
            // The point is taken to be as wide as its sector was, so that the points of a wall leave no gaps.
            let half_width = 0.5 * hit.distance / distance.max(0.25 * hit.distance);
            let centre = libm::atan2f(y, x) / per_sector;
            // The extent of the body is taken as in the direction in which the point was seen.
            let extent = hit.distance - distance_at(hit.nearness);
            let (first, last) = ((centre - half_width).round() as i32, (centre + half_width).round() as i32);
            mark(first, last, nearness(distance - extent));
        }
    }

    /// Writes the observation for a goal, given by its bearing (relative to the heading, counterclockwise positive, in rad) and
    /// its distance (in m), to `row`.
    ///
    /// Before the first scan, it is all zeros.
    ///
    /// # Panics
    /// The length of `row` is not [`SectorLayout::width`].
    pub fn encode(&self, (bearing_rad, distance_m): (f32, f32), row: &mut [f32]) {
        let count = usize::from(self.layout.count);
        let Some(EarlierScan { hits, .. }) = self.scans.back() else { return row.fill(0.0) };
        let (nearnesses, rest) = row.split_at_mut(count);
        for (value, hit) in nearnesses.iter_mut().zip(hits) {
            *value = hit.nearness;
        }
        let (changes, rest) = rest.split_at_mut(self.layout.changes());
        let (collisions, rest) = rest.split_at_mut(self.collisions.len());
        collisions.copy_from_slice(&self.collisions);
        let (predicted, rest) = rest.split_at_mut(self.predicted.len());
        predicted.copy_from_slice(&self.predicted);
        let (others, waiting) = rest.split_at_mut(OTHER_COLUMNS);
        waiting.fill(self.waiting);
        for ((value, hit), &earlier) in changes.iter_mut().zip(hits).zip(&self.earlier) {
            // Nothing is known about what was not seen before, and what is far away does not matter.
            let is_known = earlier >= 0.0 && hit.distance < MOTION_RANGE;
            let change = CHANGE_GAIN * (hit.nearness - earlier);
            *value = if is_known { change.clamp(-1.0, 1.0) } else { 0.0 };
        }
        let body = &self.body;
        let (sin, cos) = libm::sincosf(bearing_rad);
        let to_edge = (distance_m - body.goal_radius_m).max(0.0) / body.unit_m;
        others.copy_from_slice(&[
            cos,
            sin,
            nearness(to_edge),
            0.25 * libm::log1pf(to_edge),
            self.twist.0 / body.max_speed_m_s,
            self.twist.1 / body.max_turn_rad_s,
            body.step_length(),
            body.max_turn_rad_s * body.control_period_s,
        ]);
    }
}

/// Shortens `distances`, one per direction, to how far a disc with a radius of one unit can drive, in units of the robot, before
/// it collides with one of `hits`. The inner loop has no branches, so that it is vectorized.
fn shorten_paths<'a>(hits: impl Iterator<Item = &'a Hit>, directions: &Directions, distances: &mut [f32]) {
    // A beam may belong to several neighbouring sectors.
    let mut last = &NO_HIT;
    for hit in hits.filter(|hit| hit.nearness > 0.0) {
        if (hit.x, hit.y) == (last.x, last.y) {
            continue;
        }
        last = hit;
        for ((distance, sin), cos) in distances.iter_mut().zip(&directions.0).zip(&directions.1) {
            let (along, across) = (hit.x * cos + hit.y * sin, hit.x * sin - hit.y * cos);
            // The square of half the chord that the path cuts from the unit disc about the hit.
            let half_2 = 1.0 - across * across;
            let collides = (along > 0.0) & (half_2 > 0.0);
            let free = if collides { along - half_2.sqrt() } else { f32::INFINITY };
            *distance = if free < *distance { free } else { *distance };
        }
    }
}

/// The nearness of a collision after driving this `distance`, in units of the robot; 0 if it is infinite.
fn collision_nearness(distance: f32) -> f32 {
    if distance.is_finite() { nearness(distance) } else { 0.0 }
}
