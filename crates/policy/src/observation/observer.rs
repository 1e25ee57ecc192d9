//! The observer: turns scans and odometry into observations by sectors.
//!
//! In: per control step, a scan, the robot's pose by odometry and its motion; the goal. Out: a row with the columns of a
//! [`SectorLayout`]. The observer remembers the scans of the last steps and tracks what moves; after its first steps it seldom
//! allocates memory.

use std::collections::VecDeque;
use std::f32::consts::TAU;

use serde::{Deserialize, Serialize};

use super::moving::{Frame, Leg, MARGIN, Motion};
use super::sectors::{
    BodyScale, LidarBeams, OTHER_COLUMNS, SectorLayout, distance_at, nearness, sectors_of_beams,
};
use super::tracker::{Disc, FORESEEN_TURN_SIGNIFICANCE, OBSERVED_TURN_SIGNIFICANCE, Tracker};

/// The factor that the change of nearness is multiplied by.
const CHANGE_GAIN: f32 = 4.0;
/// The number of control steps that a robot looks ahead.
pub const FORESIGHT_STEPS: u32 = 15;
/// The number of positions in each of these steps that are checked for a collision.
const PARTS_OF_STEP: u32 = 2;
/// The largest distance between a moving disc and a hit that belongs to it, in units of the robot.
const DISC_MARGIN: f32 = 0.3;
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

/// What a robot may do after its next control step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FollowUp {
    /// It keeps to a motion: its speed in m/s, at most its highest, and its turning rate in rad/s.
    Keep((f32, f32)),
    /// It turns on the spot to a heading, and then drives straight ahead.
    TurnTo {
        /// The heading, in rad relative to the present one.
        heading_rad: f32,
        /// The turning rates on the spot to the left, positive, and to the right, negative.
        turns_rad_s: (f32, f32),
        /// The speed ahead, at most the robot's highest.
        ahead_m_s: f32,
    },
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
}

const NO_HIT: Hit = Hit { x: 0.0, y: 0.0, distance: f32::INFINITY, nearness: 0.0 };

/// What an observer remembers between control steps.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ObserverMemory {
    /// The scans of the last steps, the newest last: at most [`SectorLayout::earlier_steps`] + 1.
    scans: VecDeque<PooledScan>,
    /// The tracks of moving things; empty without predicted paths.
    tracker: Tracker,
}

impl ObserverMemory {
    /// Whether it remembers nothing.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.scans.is_empty()
    }

    /// The discs that move, in the frame of the newest scan, and how; see [`Tracker::moving`].
    fn moving(&self, min_turn_significance: f32, unit_m: f32) -> impl Iterator<Item = (Disc, Motion)> {
        self.scans.back().into_iter().flat_map(move |PooledScan { pose, .. }| {
            let (sin, cos) = libm::sincosf(pose.2);
            let to_present = move |(x, y): (f32, f32)| (x * cos + y * sin, y * cos - x * sin);
            let (x, y) = (pose.0 / unit_m, pose.1 / unit_m);
            self.tracker.moving(min_turn_significance).map(move |(disc, motion)| {
                let centre = to_present((disc.x - x, disc.y - y));
                let velocity = to_present(motion.velocity);
                (Disc { x: centre.0, y: centre.1, ..disc }, Motion { velocity, ..motion })
            })
        })
    }

    /// Whether it can be the memory of an observer with this layout that has taken in at least one scan.
    #[must_use]
    pub fn fits(&self, layout: SectorLayout) -> bool {
        let most = usize::from(layout.earlier_steps) + 1;
        (1..=most).contains(&self.scans.len())
            && self.scans.iter().all(|scan| scan.fits(layout))
            && self.tracker.is_valid()
    }
}

/// A scan reduced to the nearest hit in each sector.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct PooledScan {
    pose: (f32, f32, f32),
    hits: Vec<Hit>,
}

impl PooledScan {
    /// Whether it can be in the memory of an observer with this layout.
    fn fits(&self, layout: SectorLayout) -> bool {
        let is_hit = |hit: &Hit| {
            hit.x.is_finite()
                && hit.y.is_finite()
                && hit.distance >= 0.0
                && (0.0..=1.0).contains(&hit.nearness)
        };
        let (x, y, heading) = self.pose;
        let is_pose = x.is_finite() && y.is_finite() && heading.is_finite();
        is_pose && self.hits.len() == usize::from(layout.count) && self.hits.iter().all(is_hit)
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
    memory: ObserverMemory,
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
    /// What moves, where it is now, and the paths that it is expected to take.
    discs: Vec<Disc>,
    legs: Vec<Leg>,
    /// The newest scan's hits on what stands still, and on what moves.
    static_hits: Vec<Hit>,
    moving_hits: Vec<Hit>,
    /// The legs and the hits on what stands still that a robot can collide with in the next [`FORESIGHT_STEPS`].
    near_legs: Vec<Leg>,
    near_hits: Vec<(f32, f32)>,
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
        let tracker = Tracker::new(body.step_length());
        Self {
            layout,
            body,
            beams,
            is_seen,
            max_range_m: lidar.max_range_m,
            spacing_rad: lidar.spacing_rad,
            memory: ObserverMemory { scans: VecDeque::new(), tracker },
            earlier: vec![-1.0; count],
            free: vec![f32::INFINITY; count],
            collisions: vec![0.0; if layout.free_paths { count } else { 0 }],
            predicted: vec![0.0; if layout.predicted_paths { count } else { 0 }],
            waiting: 0.0,
            discs: Vec::new(),
            legs: Vec::new(),
            near_legs: Vec::new(),
            near_hits: Vec::new(),
            static_hits: Vec::new(),
            moving_hits: Vec::new(),
            directions: (0..count).map(|sector| libm::sincosf(layout.angle_rad(sector))).unzip(),
            twist: (0.0, 0.0),
        }
    }

    /// The layout of its observations.
    #[must_use]
    pub fn layout(&self) -> SectorLayout {
        self.layout
    }

    /// Forgets everything, as at the start of an episode.
    pub fn reset(&mut self) {
        self.memory.scans.clear();
        self.memory.tracker.reset();
        self.earlier.fill(-1.0);
        self.near_legs.clear();
        self.near_hits.clear();
        self.twist = (0.0, 0.0);
    }

    /// Until it is [reset](Self::reset), treats a random `fraction` (0 to 1) of the things that it has not seen before as
    /// standing still. Training does this so that a policy does not rely on predictions. The draws depend on `seed` alone.
    pub fn hide_predictions(&mut self, fraction: f32, seed: u64) {
        self.memory.tracker.hide_predictions(fraction, seed);
    }

    /// What it remembers.
    #[must_use]
    pub fn memory(&self) -> &ObserverMemory {
        &self.memory
    }

    /// Replaces what it remembers by `memory`, which [fits](ObserverMemory::fits) its layout, and `twist`, the robot's speed in
    /// m/s and turning rate in rad/s.
    pub fn restore(&mut self, memory: &ObserverMemory, twist: (f32, f32)) {
        self.reset();
        self.memory = memory.clone();
        self.twist = twist;
        self.compare();
    }

    /// Takes in what the robot senses after a control step, or at the start of an episode.
    ///
    /// # Panics
    /// The number of ranges is not that of the LIDAR's beams.
    pub fn sense(&mut self, sensed: &Sensed) {
        assert_eq!(sensed.ranges_m.len(), self.beams.len(), "one range per beam");
        self.twist = sensed.twist;
        if self.layout.predicted_paths {
            self.track(sensed);
        }
        let scans = &mut self.memory.scans;
        let oldest =
            if scans.len() > usize::from(self.layout.earlier_steps) { scans.pop_front() } else { None };
        let mut scan = oldest.unwrap_or_else(|| PooledScan { pose: sensed.pose, hits: Vec::new() });
        scan.pose = sensed.pose;
        self.pool(sensed.ranges_m, &mut scan.hits);
        self.memory.scans.push_back(scan);
        self.compare();
    }

    /// Updates the tracks of moving things.
    fn track(&mut self, sensed: &Sensed) {
        let Self { beams, body, max_range_m, memory, spacing_rad, .. } = self;
        let (x, y, heading_rad) = sensed.pose;
        let beam =
            |(beam, &range_m): (&Beam, &f32)| (beam.cos, beam.sin, range_m.min(*max_range_m) / body.unit_m);
        let beams = beams.iter().zip(sensed.ranges_m).map(beam);
        let pose = ((x / body.unit_m, y / body.unit_m), heading_rad);
        memory.tracker.add_scan(pose, *max_range_m / body.unit_m, *spacing_rad, beams);
    }

    /// Finds motion and collisions from the newest scan and those before it.
    fn compare(&mut self) {
        if self.layout.earlier_steps > 0 {
            self.move_earlier_scan();
        }
        if self.layout.predicted_paths {
            self.predict_paths();
        }
        self.find_free_distances();
        if self.layout.predicted_paths {
            self.predict_collisions();
        }
        self.find_near();
    }

    /// Finds what the robot can collide with in the next [`FORESIGHT_STEPS`], at up to its highest speed.
    fn find_near(&mut self) {
        let Self { body, memory, static_hits, near_legs, near_hits, .. } = self;
        let steps = FORESIGHT_STEPS as f32;
        let reach = steps * body.step_length() + 1.0 + MARGIN;
        near_hits.clear();
        let is_near = |(x, y): &(f32, f32)| x * x + y * y < reach * reach;
        near_hits.extend(static_hits.iter().map(|hit| (hit.x, hit.y)).filter(is_near));
        near_legs.clear();
        let moving = memory.moving(FORESEEN_TURN_SIGNIFICANCE, body.unit_m);
        let paths = moving.flat_map(|(disc, motion)| Leg::path(disc, motion));
        near_legs.extend(paths.filter(|leg| leg.comes_within(reach, steps)));
    }

    /// Finds the nearest hit in each sector.
    fn pool(&self, ranges_m: &[f32], hits: &mut Vec<Hit>) {
        hits.clear();
        hits.resize(usize::from(self.layout.count), NO_HIT);
        let per_unit = 1.0 / self.body.unit_m;
        for (beam, &range_m) in self.beams.iter().zip(ranges_m) {
            if range_m >= self.max_range_m {
                continue;
            }
            let distance = range_m * per_unit;
            let nearness = nearness(distance - beam.extent);
            let hit = Hit { x: beam.cos * distance, y: beam.sin * distance, distance, nearness };
            for &sector in &beam.sectors {
                let sector = &mut hits[sector];
                if nearness > sector.nearness {
                    *sector = hit;
                }
            }
        }
    }

    /// Finds how far a disc with a radius of one unit can drive in the direction of each sector's centre before it collides with
    /// anything in sight, and before it collides with anything that stands still.
    fn find_free_distances(&mut self) {
        let Self { memory, discs, static_hits, moving_hits, free, collisions, predicted, directions, .. } =
            self;
        let Some(PooledScan { hits, .. }) = memory.scans.back() else { return };
        static_hits.clear();
        moving_hits.clear();
        for hit in hits.iter().filter(|hit| hit.nearness > 0.0) {
            let moves = discs.iter().any(|disc| disc.contains((hit.x, hit.y), DISC_MARGIN));
            if moves { moving_hits.push(*hit) } else { static_hits.push(*hit) }
        }
        free.fill(f32::INFINITY);
        shorten_paths(static_hits, directions, free);
        if !predicted.is_empty() {
            predicted.copy_from_slice(free);
        }
        shorten_paths(moving_hits, directions, free);
        collisions.iter_mut().zip(&*free).for_each(|(value, &free)| *value = collision_nearness(free));
    }

    /// Finds what moves, and the paths that it is expected to take, in the present frame.
    fn predict_paths(&mut self) {
        let Self { memory, discs, legs, body, .. } = self;
        discs.clear();
        legs.clear();
        for (disc, motion) in memory.moving(OBSERVED_TURN_SIGNIFICANCE, body.unit_m) {
            discs.push(disc);
            legs.extend(Leg::path(disc, motion));
        }
    }

    /// Finds the nearness of collisions if what moves keeps moving: in the direction of each sector's centre at the robot's
    /// highest speed, and if the robot waits.
    fn predict_collisions(&mut self) {
        let Self { legs, predicted, collisions, directions, body, .. } = self;
        if legs.is_empty() && collisions.len() == predicted.len() {
            predicted.copy_from_slice(collisions);
            self.waiting = 0.0;
            return;
        }
        // From here to the end of the loop, `predicted` is in control steps instead of units of the robot.
        let step = body.step_length();
        predicted.iter_mut().for_each(|free| *free /= step);
        pulp::Arch::new().dispatch(
            #[inline(always)]
            || {
                for leg in legs.iter().filter(|leg| leg.is_in_reach(step)) {
                    for ((free, sin), cos) in predicted.iter_mut().zip(&directions.0).zip(&directions.1) {
                        let steps = leg.steps_to_collision((step * cos, step * sin));
                        *free = if steps < *free { steps } else { *free };
                    }
                }
            },
        );
        let waiting = legs.iter().map(|leg| leg.steps_to_collision((0.0, 0.0)));
        self.waiting = waiting.fold(f32::INFINITY, f32::min);
        predicted.iter_mut().for_each(|free| *free = collision_nearness(step * *free));
        self.waiting = collision_nearness(step * self.waiting);
    }

    /// Moves the points of the earlier scan into the present frame, by odometry.
    fn move_earlier_scan(&mut self) {
        let Self { layout, memory, earlier, body, is_seen, .. } = self;
        let scans = &memory.scans;
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
                // A huge rotation saturates.
                for sector in first..=last.min(first.saturating_add(count - 1)) {
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
            // The extent of the body is taken to be that in the direction in which the point was seen.
            let extent = hit.distance - distance_at(hit.nearness);
            let (first, last) = ((centre - half_width).round() as i32, (centre + half_width).round() as i32);
            mark(first, last, nearness(distance - extent));
        }
    }

    /// The number of control steps until the robot collides; infinite if it does not collide within [`FORESIGHT_STEPS`].
    ///
    /// The robot drives with the motion `first` (its speed in m/s, at most its highest, and its turning rate in rad/s) in the next
    /// step, and does `then` after it. What moves keeps its speed and turning rate. Only what the robot comes nearer to counts, so
    /// it may drive away from what it touches.
    ///
    /// Without predicted paths, nothing is known to move.
    #[must_use]
    pub fn steps_to_collision(&self, first: (f32, f32), then: FollowUp) -> f32 {
        let Self { body, near_legs, near_hits, .. } = self;
        if near_legs.is_empty() && near_hits.is_empty() {
            return f32::INFINITY;
        }
        let parts = PARTS_OF_STEP as f32;
        let (length, angle) = (body.control_period_s / (body.unit_m * parts), body.control_period_s / parts);
        let comes_near = |x: f32, y: f32, now: (f32, f32), reach: f32| {
            let apart_2 = x * x + y * y;
            apart_2 < reach * reach && apart_2 < now.0 * now.0 + now.1 * now.1
        };
        let (mut x, mut y, mut heading) = (0.0, 0.0, 0.0);
        for part in 1..=FORESIGHT_STEPS * PARTS_OF_STEP {
            let (v, w) = match then {
                _ if part <= PARTS_OF_STEP => first,
                FollowUp::Keep(motion) => motion,
                FollowUp::TurnTo { heading_rad, turns_rad_s: (left, right), ahead_m_s } => {
                    let rest = heading_rad - heading;
                    let rest = rest - TAU * (rest / TAU).round();
                    if rest.abs() > 1e-3 {
                        (0.0, (rest / angle).clamp(right, left))
                    } else {
                        (ahead_m_s, 0.0)
                    }
                }
            };
            let turn = w * angle;
            let (sin, cos) = libm::sincosf(heading + 0.5 * turn);
            (x, y, heading) = (x + v * length * cos, y + v * length * sin, heading + turn);
            let steps = part as f32 / parts;
            let hits_static = || near_hits.iter().any(|&hit| comes_near(hit.0 - x, hit.1 - y, hit, 1.0));
            let hits_moving = near_legs.iter().any(|leg| {
                let Disc { x: now_x, y: now_y, radius } = leg.disc;
                leg.position(steps)
                    .is_some_and(|at| comes_near(at.0 - x, at.1 - y, (now_x, now_y), 1.0 + radius))
            });
            if hits_moving || hits_static() {
                return steps;
            }
        }
        f32::INFINITY
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
        let Some(PooledScan { hits, .. }) = self.memory.scans.back() else { return row.fill(0.0) };
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
fn shorten_paths(hits: &[Hit], directions: &Directions, distances: &mut [f32]) {
    pulp::Arch::new().dispatch(
        #[inline(always)]
        || {
            // A beam may belong to several neighbouring sectors.
            let mut last = &NO_HIT;
            for hit in hits {
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
        },
    );
}

/// The nearness of a collision after driving this `distance`, in units of the robot; 0 if it is infinite.
fn collision_nearness(distance: f32) -> f32 {
    if distance.is_finite() { nearness(distance) } else { 0.0 }
}
