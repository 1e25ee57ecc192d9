//! Things that move, tracked from scan to scan.
//!
//! Each compact thing in sight is taken to be a disc with a constant speed and turning rate. An extended Kalman filter estimates
//! its position, velocity, turning rate and radius from the beams that hit it and from the adjacent beams that pass it. So a few
//! beams are enough, and a thing is not lost when no beam hits it for a moment. A track counts as moving if its velocity differs
//! from zero by more than two standard deviations, and if the scans show that it has moved: earlier scans saw through the places
//! where it is hit now, or the newest scan sees through the places where it was hit earlier. The hits on walls and rocks move,
//! too, as the robot drives, but other scans show a surface there.
//!
//! Positions are in the odometry frame. Lengths are in units of the robot, which `sectors.rs` defines; times are in control
//! steps.

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use super::moving::Motion;

/// The largest number of beams that are used. Of more beams, only every second one is used, or every third one, and so on.
const MAX_BEAMS: usize = 72;
/// The largest number of tracks.
const MAX_TRACKS: usize = 64;
/// The number of earlier scans that are remembered.
const REMEMBERED_SCANS: usize = 12;
/// The newest scan is compared with the oldest of these, and with every sixth one after it.
const COMPARED_EVERY: usize = 6;

/// The mean and the standard deviation of the radius of a thing that has not been seen before.
const RADIUS: (f32, f32) = (1.1, 0.4);
/// The standard deviation of the position of such a thing.
const POSITION_SD: f32 = 0.6;
/// The standard deviation of its velocity, relative to the robot's highest speed.
const SPEED_SD: f32 = 1.2;
/// The standard deviation of the change of a velocity in a control step, relative to the robot's highest speed.
const ACCELERATION_SD: f32 = 0.05;
/// The standard deviation of the turn of a new thing in a control step, in rad.
const TURN_SD: f32 = 0.05;
/// The standard deviation of the change of a turn from one control step to the next, in rad.
const TURN_CHANGE_SD: f32 = 0.005;
/// The largest turn in a control step, in rad.
const MAX_TURN: f32 = 0.3;
/// In observations, a thing is taken to drive straight on unless its squared turn, in variances, exceeds this. The value is
/// cautious, so that a policy does not learn to rely on predicted turns.
pub(super) const OBSERVED_TURN_SIGNIFICANCE: f32 = 2.0;
/// The same in foresight, the check whether actions lead to a collision (`decision.rs`).
pub(super) const FORESEEN_TURN_SIGNIFICANCE: f32 = 1.0;
/// If the misfit is larger than this, the thing may have changed its motion, or may not be a disc.
const MANOEUVRE_MISFIT: f32 = 0.5;
/// How much the variance of the acceleration grows for each unit of misfit above that, relative to the usual variance.
const MANOEUVRE_GAIN: f32 = 4.0;
/// The standard deviation of the distance from a hit to the edge of its disc.
const HIT_SD: f32 = 0.1;
/// The standard deviation of the overlap of a disc with a beam that passes it.
const PASS_SD: f32 = 0.2;
/// The range of a radius.
const RADII: (f32, f32) = (0.1, 5.0);

/// A hit belongs to a track if its squared distance from the disc's edge, in variances, is less than this.
const GATE: f32 = 9.0;
/// The largest distance of a hit from the edge of its disc.
const MAX_DISTANCE: f32 = 1.5;
/// A beam hits the near side of a disc: the cosine of the angle between its direction and the outward normal is at most this.
const MAX_COSINE: f32 = 0.2;
/// Neighbouring hits belong to the same thing if their distance is at most this many times the distance between beams there.
const LINK: f32 = 2.0;
/// A scan shows a surface between neighbouring hits if their distance is at most this many times the distance between beams there.
const SURFACE_LINK: f32 = 3.0;
/// Neighbouring hits also belong to the same thing if their distance is at most this.
const MIN_LINK: f32 = 0.5;
/// The largest extent of a compact thing. Larger things are taken for walls.
const MAX_EXTENT: f32 = 4.0;
/// Hits that are at most this far from the line between the hits on both sides belong to a wall.
const WALL_MARGIN: f32 = 0.3;
/// A beam shows that a disc is not there if it passes within this many radii of its centre.
const CENTRE: f32 = 0.7;
/// A place is on a surface if it is less than this away from the surface. A scan sees through a place if the
/// beams on both sides go more than this beyond it.
const SURFACE_MARGIN: f32 = 0.3;
/// Beams are neighbours if the angle between them is less than this many times that between neighbouring beams of the LIDAR.
const NEIGHBOURS: f32 = 1.5;
/// A thing does not fit between two beams if their distance there is less than this many of its radii.
const MAX_GAP: f32 = 1.7;
/// An earlier hit belongs to a disc if it is inside the disc at its position at that time, or at most this far outside.
const EARLIER_HIT_MARGIN: f32 = 0.2;

/// The smallest number of scans in which a moving thing has been seen.
const MIN_SEEN: u16 = 3;
/// The smallest squared velocity of a moving thing, in variances.
const MIN_SIGNIFICANCE: f32 = 4.0;
/// The least evidence with which a thing counts as having moved.
const MIN_EVIDENCE: f32 = 0.5;
/// The most evidence that a track accumulates.
const MAX_EVIDENCE: f32 = 1.5;
/// The weight of a place on a surface, as evidence against motion, relative to a place that is seen through.
const SURFACE_EVIDENCE: f32 = 0.3;
/// The smallest speed of a moving thing, relative to the robot's highest speed.
const MIN_SPEED: f32 = 0.1;
/// A track is dropped if no beam has hit it in more than this many scans in a row.
const MAX_MISSED: u16 = 5;
/// The largest misfit of a moving thing, and of a track. The misfit is 1 on average for a disc whose hits scatter by [`HIT_SD`].
const MAX_MISFIT: (f32, f32) = (4.0, 8.0);
/// How much the newest hit counts in the misfit.
const MISFIT_GAIN: f32 = 0.2;

/// The beams of a scan, counterclockwise.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(from = "StoredRays", into = "StoredRays")]
pub(super) struct Rays {
    origin: (f32, f32),
    /// The directions of the beams: cosines and sines.
    cos: Vec<f32>,
    sin: Vec<f32>,
    /// The lengths of the beams.
    length: Vec<f32>,
    /// The length of a beam that has hit nothing.
    max_range: f32,
    /// The ends of the beams; infinite for a beam that has hit nothing.
    end_x: Vec<f32>,
    end_y: Vec<f32>,
}

/// [`Rays`] as a checkpoint stores them: without the ends, which are computed from the rest.
#[derive(Serialize, Deserialize)]
struct StoredRays {
    origin: (f32, f32),
    cos: Vec<f32>,
    sin: Vec<f32>,
    length: Vec<f32>,
    max_range: f32,
}

impl From<StoredRays> for Rays {
    fn from(StoredRays { origin, cos, sin, length, max_range }: StoredRays) -> Self {
        let mut rays = Self { origin, cos, sin, length, max_range, end_x: Vec::new(), end_y: Vec::new() };
        rays.find_ends();
        rays
    }
}

impl From<Rays> for StoredRays {
    fn from(Rays { origin, cos, sin, length, max_range, .. }: Rays) -> Self {
        Self { origin, cos, sin, length, max_range }
    }
}

impl Rays {
    /// Replaces the rays by those of a scan that was taken at `pose`. Each of `beams` is the direction in the robot's frame (cosine
    /// and sine) and the length, `max_range` for a beam that has hit nothing. Returns how many beams each ray stands for.
    pub(super) fn fill(
        &mut self,
        pose: ((f32, f32), f32),
        max_range: f32,
        beams: impl ExactSizeIterator<Item = (f32, f32, f32)>,
    ) -> usize {
        let (sin, cos) = libm::sincosf(pose.1);
        let stride = beams.len().div_ceil(MAX_BEAMS).max(1);
        self.origin = pose.0;
        self.max_range = max_range;
        [&mut self.cos, &mut self.sin, &mut self.length].into_iter().for_each(Vec::clear);
        for (beam_cos, beam_sin, length) in beams.step_by(stride) {
            self.cos.push(beam_cos * cos - beam_sin * sin);
            self.sin.push(beam_cos * sin + beam_sin * cos);
            self.length.push(length);
        }
        self.find_ends();
        stride
    }

    fn find_ends(&mut self) {
        let Self { origin, cos, sin, length, max_range, end_x, end_y } = self;
        let end = |from: f32, direction: f32, length: f32| {
            if length < *max_range { from + direction * length } else { f32::INFINITY }
        };
        end_x.clear();
        end_x.extend(cos.iter().zip(&*length).map(|(cos, length)| end(origin.0, *cos, *length)));
        end_y.clear();
        end_y.extend(sin.iter().zip(&*length).map(|(sin, length)| end(origin.1, *sin, *length)));
    }

    fn len(&self) -> usize {
        self.length.len()
    }

    /// The end of a ray that has hit something.
    fn end(&self, ray: usize) -> Option<(f32, f32)> {
        (self.length[ray] < self.max_range).then(|| (self.end_x[ray], self.end_y[ray]))
    }

    /// The point of a ray at a distance from its origin.
    fn at(&self, ray: usize, distance: f32) -> (f32, f32) {
        (self.origin.0 + self.cos[ray] * distance, self.origin.1 + self.sin[ray] * distance)
    }

    /// The distance of a point along a ray, and to the left of the ray.
    fn along_and_across(&self, ray: usize, (x, y): (f32, f32)) -> (f32, f32) {
        let (dx, dy) = (x - self.origin.0, y - self.origin.1);
        let (cos, sin) = (self.cos[ray], self.sin[ray]);
        (dx * cos + dy * sin, dy * cos - dx * sin)
    }

    /// Whether a ray passes through the middle of `disc`. Without branches, so that the loop is vectorized.
    fn pass_through(&self, disc: &Disc) -> bool {
        let (dx, dy) = (disc.x - self.origin.0, disc.y - self.origin.1);
        let near = CENTRE * disc.radius;
        let mut passes = false;
        for ((cos, sin), length) in self.cos.iter().zip(&self.sin).zip(&self.length) {
            let (along, across) = (dx * cos + dy * sin, dy * cos - dx * sin);
            passes |= (along > 0.0) & (across.abs() < near) & (*length > along);
        }
        passes
    }

    /// The rays that have hit something within `distance` of `(x, y)`, and their ends.
    fn hits_near(&self, (x, y): (f32, f32), distance: f32) -> impl Iterator<Item = (usize, (f32, f32))> {
        // Without branches, so that the loop is vectorized.
        let mut are_near = [false; MAX_BEAMS];
        for ((is_near, end_x), end_y) in are_near.iter_mut().zip(&self.end_x).zip(&self.end_y) {
            let (dx, dy) = (end_x - x, end_y - y);
            *is_near = dx * dx + dy * dy < distance * distance;
        }
        (0..self.len()).filter(move |ray| are_near[*ray]).map(|ray| (ray, (self.end_x[ray], self.end_y[ray])))
    }

    /// The neighbouring rays to the right and left of a place; `None` outside the field of view. There is at most one such pair;
    /// the search for it begins at the ray `near`.
    fn beside(&self, place: (f32, f32), spacing_rad: f32, near: usize) -> Option<(usize, usize)> {
        let count = self.len();
        // A checkpoint may hold scans with different numbers of beams.
        let near = near.min(count.checked_sub(1)?);
        let right_of = |left: usize| if left > 0 { left - 1 } else { count - 1 };
        let left = (0..count)
            .map(|k| if k % 2 == 0 { near + k / 2 } else { near + count - k.div_ceil(2) })
            .map(|ray| if ray < count { ray } else { ray - count })
            .find(|&left| {
                let (along, across) = self.along_and_across(left, place);
                across < 0.0 && along > 0.0 && {
                    let (along, across) = self.along_and_across(right_of(left), place);
                    across >= 0.0 && along > 0.0
                }
            })?;
        let right = right_of(left);
        let gap = apart((self.cos[right], self.sin[right]), (self.cos[left], self.sin[left]));
        (gap < NEIGHBOURS * spacing_rad).then_some((right, left))
    }

    /// What the scan shows of a place where the ray `near` of another scan has hit a thing of this `radius`.
    fn sight(&self, (near, place): (usize, (f32, f32)), spacing_rad: f32, radius: f32) -> Sight {
        let Some((right, left)) = self.beside(place, spacing_rad, near) else { return Sight::Unknown };
        let shorter = self.length[right].min(self.length[left]);
        let to_surface = match (self.end(right), self.end(left)) {
            (Some(one), Some(other)) => {
                let is_linked = apart(one, other) <= (SURFACE_LINK * spacing_rad * shorter).max(MIN_LINK);
                if is_linked {
                    from_segment(place, one, other)
                } else {
                    apart(place, one).min(apart(place, other))
                }
            }
            (Some(end), None) | (None, Some(end)) => apart(place, end),
            (None, None) => f32::INFINITY,
        };
        let distance = apart(place, self.origin);
        let fits_between = spacing_rad * distance >= MAX_GAP * radius;
        if to_surface < SURFACE_MARGIN {
            Sight::Surface
        } else if distance + SURFACE_MARGIN < shorter && !fits_between {
            Sight::Free
        } else {
            Sight::Unknown
        }
    }

    fn is_valid(&self) -> bool {
        let Self { origin, cos, sin, length, max_range, .. } = self;
        let count = length.len();
        let are_finite = |values: &[f32]| values.iter().all(|value| value.is_finite());
        count <= MAX_BEAMS
            && cos.len() == count
            && sin.len() == count
            && are_finite(&[origin.0, origin.1])
            && are_finite(cos)
            && are_finite(sin)
            && max_range.is_finite()
            && length.iter().all(|length| (0.0..=*max_range).contains(length))
    }
}

/// What a scan shows of a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sight {
    /// A surface is there.
    Surface,
    /// The scan sees through it.
    Free,
    /// It is hidden, out of view or out of range, or the thing would fit between the beams.
    Unknown,
}

/// The number of places that were looked up in scans, and how many of them were free or on a surface.
#[derive(Clone, Copy, Debug, Default)]
struct Sights {
    places: f32,
    free: f32,
    surfaces: f32,
}

impl Sights {
    fn add(&mut self, sight: Sight) {
        self.places += 1.0;
        match sight {
            Sight::Free => self.free += 1.0,
            Sight::Surface => self.surfaces += 1.0,
            Sight::Unknown => {}
        }
    }
}

/// A disc.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Disc {
    pub(super) x: f32,
    pub(super) y: f32,
    pub(super) radius: f32,
}

impl Disc {
    /// Whether a point is inside the disc, or at most `margin` outside.
    pub(super) fn contains(&self, (x, y): (f32, f32), margin: f32) -> bool {
        let (dx, dy) = (x - self.x, y - self.y);
        let reach = self.radius + margin;
        dx * dx + dy * dy < reach * reach
    }
}

/// The distance between two points.
fn apart(one: (f32, f32), other: (f32, f32)) -> f32 {
    let (dx, dy) = (one.0 - other.0, one.1 - other.1);
    (dx * dx + dy * dy).sqrt()
}

/// The distance of a place from the line segment between two points.
fn from_segment(place: (f32, f32), one: (f32, f32), other: (f32, f32)) -> f32 {
    let (dx, dy) = (other.0 - one.0, other.1 - one.1);
    let along = (place.0 - one.0) * dx + (place.1 - one.1) * dy;
    let t = (along / (dx * dx + dy * dy).max(1e-6)).clamp(0.0, 1.0);
    apart(place, (one.0 + t * dx, one.1 + t * dy))
}

/// The estimate of a disc that moves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Track {
    disc: Disc,
    velocity: (f32, f32),
    /// By how much the velocity turns in a control step, counterclockwise positive, in rad.
    turn: f32,
    /// The covariance of x, y, the velocity's x and y, the radius, and the turn.
    covariance: [[f32; 6]; 6],
    /// The number of scans in which a beam has hit it.
    seen: u16,
    /// The number of scans since a beam last hit it.
    missed: u16,
    /// A mean of the squared distances of its last hits from the edge, in variances.
    misfit: f32,
    /// The evidence that it has moved: 0 to [`MAX_EVIDENCE`].
    evidence: f32,
    /// Whether its motion is hidden, see [`Dropout`].
    is_hidden: bool,
}

impl Track {
    /// The track of a new thing at this position, before its first hit.
    fn new((x, y): (f32, f32), max_speed: f32, is_hidden: bool) -> Self {
        let speed_sd = SPEED_SD * max_speed;
        let mut covariance = [[0.0; 6]; 6];
        let deviations = [POSITION_SD, POSITION_SD, speed_sd, speed_sd, RADIUS.1, TURN_SD];
        deviations.into_iter().enumerate().for_each(|(k, sd)| covariance[k][k] = sd * sd);
        let disc = Disc { x, y, radius: RADIUS.0 };
        let (velocity, turn) = ((0.0, 0.0), 0.0);
        Self { disc, velocity, turn, covariance, seen: 0, missed: 0, misfit: 1.0, evidence: 0.0, is_hidden }
    }

    /// Moves it on by one control step.
    fn predict(&mut self, max_speed: f32) {
        self.missed = self.missed.saturating_add(1);
        let (sin, cos) = libm::sincosf(self.turn);
        let turned = |(x, y): (f32, f32)| (x * cos - y * sin, x * sin + y * cos);
        let before = self.velocity;
        self.velocity = turned(before);
        // The mean of the velocities before and after the step.
        self.disc.x += 0.5 * (before.0 + self.velocity.0);
        self.disc.y += 0.5 * (before.1 + self.velocity.1);
        let p = &mut self.covariance;
        // First the rows are multiplied by the Jacobian of this motion, then the columns.
        for _ in 0..2 {
            for row in p.iter_mut() {
                let [_, _, x, y, _, turn] = *row;
                let after = turned((x, y));
                row[2] = after.0 - self.velocity.1 * turn;
                row[3] = after.1 + self.velocity.0 * turn;
                row[0] += 0.5 * (x + row[2]);
                row[1] += 0.5 * (y + row[3]);
            }
            *p = std::array::from_fn(|k| std::array::from_fn(|other| p[other][k]));
        }
        p[5][5] += TURN_CHANGE_SD * TURN_CHANGE_SD;
        // The velocity changes at a constant rate during the step.
        let growth = 1.0 + MANOEUVRE_GAIN * (self.misfit - MANOEUVRE_MISFIT).max(0.0);
        let variance = (ACCELERATION_SD * max_speed) * (ACCELERATION_SD * max_speed) * growth;
        for (position, velocity) in [(0, 2), (1, 3)] {
            p[position][position] += 0.25 * variance;
            p[position][velocity] += 0.5 * variance;
            p[velocity][position] += 0.5 * variance;
            p[velocity][velocity] += variance;
        }
    }

    /// The covariance of the state with a quantity whose gradient is `gradient` (of x, y and the radius), and the variance of that
    /// quantity.
    fn covariance_with(&self, gradient: (f32, f32, f32)) -> ([f32; 6], f32) {
        let (x, y, radius) = gradient;
        let with: [f32; 6] = std::array::from_fn(|k| {
            self.covariance[k][0] * x + self.covariance[k][1] * y + self.covariance[k][4] * radius
        });
        (with, with[0] * x + with[1] * y + with[4] * radius)
    }

    /// Updates the estimate with a quantity that has this `value` and should be 0, with the standard deviation `sd`. `gradient`:
    /// see [`covariance_with`](Self::covariance_with). Returns the squared value in variances.
    fn correct(&mut self, value: f32, gradient: (f32, f32, f32), sd: f32) -> f32 {
        let (with, variance) = self.covariance_with(gradient);
        let variance = variance + sd * sd;
        let gain = -value / variance;
        self.disc.x += gain * with[0];
        self.disc.y += gain * with[1];
        self.velocity.0 += gain * with[2];
        self.velocity.1 += gain * with[3];
        self.disc.radius = (self.disc.radius + gain * with[4]).clamp(RADII.0, RADII.1);
        self.turn = (self.turn + gain * with[5]).clamp(-MAX_TURN, MAX_TURN);
        for (row, one) in self.covariance.iter_mut().zip(with) {
            for (value, other) in row.iter_mut().zip(with) {
                *value -= one * other / variance;
            }
        }
        value * value / variance
    }

    /// The distance of a point from the edge of the disc, positive outside, and the outward normal there.
    fn edge_distance(&self, (x, y): (f32, f32)) -> (f32, (f32, f32)) {
        let (dx, dy) = (x - self.disc.x, y - self.disc.y);
        let distance = (dx * dx + dy * dy).sqrt().max(1e-3);
        (distance - self.disc.radius, (dx / distance, dy / distance))
    }

    /// The squared distance of a hit from the edge, in variances; infinite if the beam cannot have hit this disc.
    fn mismatch(&self, rays: &Rays, ray: usize, hit: (f32, f32)) -> f32 {
        let (distance, normal) = self.edge_distance(hit);
        let cosine = normal.0 * rays.cos[ray] + normal.1 * rays.sin[ray];
        if distance.abs() > MAX_DISTANCE || cosine > MAX_COSINE {
            return f32::INFINITY;
        }
        let (_, variance) = self.covariance_with((-normal.0, -normal.1, -1.0));
        distance * distance / (variance + HIT_SD * HIT_SD)
    }

    /// Updates the estimate with the hit of a beam.
    fn add_hit(&mut self, hit: (f32, f32)) {
        let (distance, normal) = self.edge_distance(hit);
        let mismatch = self.correct(distance, (-normal.0, -normal.1, -1.0), HIT_SD);
        self.misfit += MISFIT_GAIN * (mismatch - self.misfit);
        if self.missed > 0 || self.seen == 0 {
            self.missed = 0;
            self.seen = self.seen.saturating_add(1);
        }
    }

    /// Updates the estimate with a beam that has not hit it.
    fn add_pass(&mut self, rays: &Rays, ray: usize) {
        let (along, across) = rays.along_and_across(ray, (self.disc.x, self.disc.y));
        let overlap = self.disc.radius - across.abs();
        if along <= 0.0 || rays.length[ray] < along || overlap <= 0.0 {
            return;
        }
        // The gradient of the overlap: it shrinks as the disc moves away from the beam.
        let side = if across < 0.0 { 1.0 } else { -1.0 };
        self.correct(overlap, (-side * rays.sin[ray], side * rays.cos[ray], 1.0), PASS_SD);
    }

    /// Whether its speed exceeds [`MIN_SPEED`], and its squared velocity, in variances, exceeds [`MIN_SIGNIFICANCE`].
    fn is_fast(&self, max_speed: f32) -> bool {
        let (x, y) = self.velocity;
        let p = &self.covariance;
        let (xx, xy, yy) = (p[2][2], p[2][3], p[3][3]);
        let determinant = xx * yy - xy * xy;
        let min_speed = MIN_SPEED * max_speed;
        x * x + y * y > min_speed * min_speed
            && yy * x * x - 2.0 * xy * x * y + xx * y * y > MIN_SIGNIFICANCE * determinant
    }

    /// The motion to expect of it: an uncertain turn is taken to be smaller than the estimate, or 0 if its square is less than
    /// `min_significance` variances.
    fn motion(&self, min_significance: f32) -> Motion {
        let significance = self.turn * self.turn / self.covariance[5][5];
        let part = 1.0 - min_significance / significance.max(min_significance);
        Motion { velocity: self.velocity, turn: part * self.turn }
    }

    fn is_valid(&self) -> bool {
        let Self { disc, velocity, turn, covariance, misfit, evidence, .. } = self;
        let numbers = [disc.x, disc.y, velocity.0, velocity.1, *turn, *misfit];
        numbers.iter().chain(covariance.iter().flatten()).all(|number| number.is_finite())
            && (RADII.0..=RADII.1).contains(&disc.radius)
            && turn.abs() <= MAX_TURN
            && (0.0..=MAX_EVIDENCE).contains(evidence)
    }
}

/// Hides the predictions of a random fraction of the tracks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Dropout {
    fraction: f32,
    /// The state of the random number generator, SplitMix64 (Steele et al. 2014).
    state: u64,
}

impl Dropout {
    /// Whether the motion of a new track is hidden.
    fn draw(&mut self) -> bool {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.state;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        bits ^= bits >> 31;
        let uniform_01 = (bits >> 40) as f32 / (1_u32 << 24) as f32;
        uniform_01 < self.fraction
    }
}

/// The tracks of all compact things in sight.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Tracker {
    tracks: Vec<Track>,
    /// The rays of the last scans, the newest last.
    scans: VecDeque<Rays>,
    /// For each ray of the newest scan, the track that it has hit.
    #[serde(skip)]
    track_of_ray: Vec<Option<u16>>,
    /// The mismatch of that track, or [`GATE`] if there is none.
    #[serde(skip)]
    mismatch_of_ray: Vec<f32>,
    /// The robot's highest speed.
    max_speed: f32,
    dropout: Dropout,
}

impl Tracker {
    /// A tracker for a robot with this highest speed.
    pub(super) fn new(max_speed: f32) -> Self {
        Self { max_speed, ..Self::default() }
    }

    /// Forgets all tracks and scans, and no longer hides predictions of new tracks.
    pub(super) fn reset(&mut self) {
        self.tracks.clear();
        self.scans.clear();
        self.dropout = Dropout::default();
    }

    /// From now on, hides the predictions of a random fraction of new tracks. The draws depend on `seed`.
    pub(super) fn hide_predictions(&mut self, fraction: f32, seed: u64) {
        self.dropout = Dropout { fraction, state: seed };
    }

    /// The discs that move, and how. For `min_turn_significance` see [`OBSERVED_TURN_SIGNIFICANCE`].
    pub(super) fn moving(&self, min_turn_significance: f32) -> impl Iterator<Item = (Disc, Motion)> {
        let moves = |track: &&Track| {
            !track.is_hidden
                && track.evidence >= MIN_EVIDENCE
                && track.seen >= MIN_SEEN
                && track.misfit < MAX_MISFIT.0
                && track.is_fast(self.max_speed)
        };
        let motion = move |track: &Track| (track.disc, track.motion(min_turn_significance));
        self.tracks.iter().filter(moves).map(motion)
    }

    /// Adds the scan after a control step. Each of `beams` is its direction in the robot's frame (cosine and sine) and its
    /// length, `max_range` if it has hit nothing; `pose` is the robot's position and heading.
    pub(super) fn add_scan(
        &mut self,
        pose: ((f32, f32), f32),
        max_range: f32,
        spacing_rad: f32,
        beams: impl ExactSizeIterator<Item = (f32, f32, f32)>,
    ) {
        let is_full = self.scans.len() > REMEMBERED_SCANS;
        let mut rays = if is_full { self.scans.pop_front() } else { None }.unwrap_or_default();
        let spacing_rad = spacing_rad * rays.fill(pose, max_range, beams) as f32;
        self.tracks.iter_mut().for_each(|track| track.predict(self.max_speed));
        self.assign(&rays);
        self.start_tracks(&rays, spacing_rad);
        self.correct(&rays);
        self.weigh_evidence(&rays, spacing_rad);
        self.tracks.retain(|track| {
            let is_gone = track.missed > 0 && rays.pass_through(&track.disc);
            !is_gone && track.missed <= MAX_MISSED && track.misfit < MAX_MISFIT.1 && track.is_valid()
        });
        self.scans.push_back(rays);
    }

    /// Assigns each hit to the track that explains it best.
    fn assign(&mut self, rays: &Rays) {
        let Self { tracks, track_of_ray, mismatch_of_ray, .. } = self;
        track_of_ray.clear();
        track_of_ray.resize(rays.len(), None);
        mismatch_of_ray.clear();
        mismatch_of_ray.resize(rays.len(), GATE);
        for (index, track) in tracks.iter().enumerate() {
            let Disc { x, y, radius } = track.disc;
            for (ray, hit) in rays.hits_near((x, y), radius + MAX_DISTANCE) {
                let mismatch = track.mismatch(rays, ray, hit);
                if mismatch < mismatch_of_ray[ray] {
                    mismatch_of_ray[ray] = mismatch;
                    track_of_ray[ray] = Some(index as u16);
                }
            }
        }
    }

    /// Starts a track for each compact group of neighbouring hits that belong to no track.
    fn start_tracks(&mut self, rays: &Rays, spacing_rad: f32) {
        let Self { tracks, track_of_ray, max_speed, dropout, .. } = self;
        let count = rays.len();
        let next = |ray: usize| if ray + 1 < count { ray + 1 } else { 0 };
        let new_hit = |ray: usize, owners: &[Option<u16>]| {
            if owners[ray].is_none() { rays.end(ray) } else { None }
        };
        let are_linked = |one: usize, other: usize, owners: &[Option<u16>]| {
            let (Some(a), Some(b)) = (new_hit(one, owners), new_hit(other, owners)) else { return false };
            let between_beams = spacing_rad * rays.length[one].min(rays.length[other]);
            apart(a, b) <= (LINK * between_beams).max(MIN_LINK)
        };
        // A LIDAR with a field of view of 360 degrees may see one thing with its first and last beams.
        let Some(first) = (0..count).find(|&ray| !are_linked(ray, next(ray), track_of_ray)).map(next) else {
            return;
        };
        let at = |index: usize| if first + index < count { first + index } else { first + index - count };
        let mut start = 0;
        for end in 1..=count {
            if end < count && are_linked(at(end - 1), at(end), track_of_ray) {
                continue;
            }
            let ends = (new_hit(at(start), track_of_ray), new_hit(at(end - 1), track_of_ray));
            let before = rays.end(at(if start > 0 { start - 1 } else { count - 1 }));
            let after = rays.end(at(if end < count { end } else { 0 }));
            let is_wall = || {
                let (Some(before), Some(after)) = (before, after) else { return false };
                let length = apart(before, after).max(1e-3);
                let (cos, sin) = ((after.0 - before.0) / length, (after.1 - before.1) / length);
                (start..end).filter_map(|index| rays.end(at(index))).all(|hit| {
                    let across = (hit.1 - before.1) * cos - (hit.0 - before.0) * sin;
                    across.abs() <= WALL_MARGIN
                })
            };
            if let (Some(one), Some(other)) = ends
                && apart(one, other) <= MAX_EXTENT
                && tracks.len() < MAX_TRACKS
                && !is_wall()
            {
                let middle = at((start + end - 1) / 2);
                let centre = rays.at(middle, rays.length[middle] + RADIUS.0);
                (start..end).for_each(|index| track_of_ray[at(index)] = Some(tracks.len() as u16));
                tracks.push(Track::new(centre, *max_speed, dropout.draw()));
            }
            start = end;
        }
    }

    /// Corrects the tracks with their hits, then with the adjacent beams that pass them.
    fn correct(&mut self, rays: &Rays) {
        let Self { tracks, track_of_ray, .. } = self;
        for (ray, owner) in track_of_ray.iter().enumerate() {
            if let (Some(owner), Some(hit)) = (owner, rays.end(ray)) {
                tracks[usize::from(*owner)].add_hit(hit);
            }
        }
        let count = rays.len();
        for ray in 0..count {
            let before = track_of_ray[if ray > 0 { ray - 1 } else { count - 1 }];
            let after = track_of_ray[if ray + 1 < count { ray + 1 } else { 0 }];
            let beside = [before, after.filter(|_| after != before)];
            for owner in beside.into_iter().flatten().filter(|owner| track_of_ray[ray] != Some(*owner)) {
                tracks[usize::from(owner)].add_pass(rays, ray);
            }
        }
    }

    /// Compares hits with what other scans show there, and adds the result to the evidence that fast tracks have moved.
    fn weigh_evidence(&mut self, rays: &Rays, spacing_rad: f32) {
        let Self { tracks, scans, max_speed, track_of_ray, .. } = self;
        for (index, track) in tracks.iter_mut().enumerate() {
            if track.seen < MIN_SEEN || !track.is_fast(*max_speed) {
                continue;
            }
            let mut sights = Sights::default();
            let Disc { x, y, radius } = track.disc;
            let earlier_scans =
                || (0..scans.len()).step_by(COMPARED_EVERY).map(|index| (scans.len() - index, &scans[index]));
            let hits = track_of_ray.iter().enumerate().filter(|(_, owner)| **owner == Some(index as u16));
            for hit in hits.filter_map(|(ray, _)| Some((ray, rays.end(ray)?))) {
                earlier_scans().for_each(|(_, earlier)| sights.add(earlier.sight(hit, spacing_rad, radius)));
            }
            // Mostly surfaces and nothing free: it stands still, and the hits of earlier scans need not be looked at.
            if sights.free > 0.0 || 2.0 * sights.surfaces <= sights.places {
                let motion = track.motion(OBSERVED_TURN_SIGNIFICANCE);
                for (age, earlier) in earlier_scans() {
                    let (dx, dy) = motion.displacement(-(age as f32));
                    let hits = earlier.hits_near((x + dx, y + dy), radius + EARLIER_HIT_MARGIN);
                    hits.for_each(|hit| sights.add(rays.sight(hit, spacing_rad, radius)));
                }
            }
            let Sights { places, free, surfaces } = sights;
            if places > 0.0 {
                let evidence = (free - SURFACE_EVIDENCE * surfaces) / places;
                track.evidence = (track.evidence + evidence).clamp(0.0, MAX_EVIDENCE);
            }
        }
    }

    /// Whether it can be the state of a tracker.
    pub(super) fn is_valid(&self) -> bool {
        self.tracks.len() <= MAX_TRACKS
            && self.scans.len() <= REMEMBERED_SCANS + 1
            && self.max_speed.is_finite()
            && (0.0..=1.0).contains(&self.dropout.fraction)
            && self.tracks.iter().all(Track::is_valid)
            && self.scans.iter().all(Rays::is_valid)
    }
}

#[cfg(test)]
mod tests {
    use std::f32::consts::TAU;

    use super::*;

    const MAX_RANGE: f32 = 27.0;
    /// Half the side of the square room, which is centred on the origin.
    const HALF_ROOM: f32 = 15.0;

    /// The length of a beam from `origin` in the room with these discs.
    fn cast(origin: (f32, f32), (cos, sin): (f32, f32), discs: &[Disc]) -> f32 {
        let to_wall = |at: f32, along: f32| {
            if along == 0.0 { f32::INFINITY } else { (HALF_ROOM * along.signum() - at) / along }
        };
        let to_disc = |disc: &Disc| {
            let (dx, dy) = (disc.x - origin.0, disc.y - origin.1);
            let (along, across) = (dx * cos + dy * sin, dy * cos - dx * sin);
            let half_2 = disc.radius * disc.radius - across * across;
            if along > 0.0 && half_2 > 0.0 { along - half_2.sqrt() } else { f32::INFINITY }
        };
        let to_walls = to_wall(origin.0, cos).min(to_wall(origin.1, sin));
        let length = discs.iter().map(to_disc).fold(to_walls, f32::min);
        assert!(length > 0.0, "{origin:?} is inside something");
        length.min(MAX_RANGE)
    }

    /// The robot's position and heading, if it drives at half a unit a step in a circle.
    fn in_a_circle(step: f32) -> ((f32, f32), f32) {
        let heading = 0.1 * step;
        ((5.0 * heading.sin() - 4.0, 5.0 - 5.0 * heading.cos()), heading)
    }

    /// A LIDAR, by its number of beams and its field of view in rad.
    #[derive(Clone, Copy)]
    struct Lidar(u8, f32);

    impl Lidar {
        fn spacing_rad(self) -> f32 {
            self.1 / f32::from(self.0)
        }

        /// Adds the scan from a position and heading to `tracker`.
        fn scan(self, tracker: &mut Tracker, (origin, heading): ((f32, f32), f32), discs: &[Disc]) {
            let beams: Vec<(f32, f32, f32)> = (0..self.0)
                .map(|beam| {
                    let angle = f32::from(beam) * self.spacing_rad() - 0.5 * self.1;
                    let direction = ((angle + heading).cos(), (angle + heading).sin());
                    (angle.cos(), angle.sin(), cast(origin, direction, discs))
                })
                .collect();
            tracker.add_scan((origin, heading), MAX_RANGE, self.spacing_rad(), beams.into_iter());
        }
    }

    const FEW_BEAMS: Lidar = Lidar(24, TAU);

    /// The tracker of a robot that has driven in a circle for this many steps, among the `discs` of each step.
    fn track(steps: u8, discs: impl Fn(f32) -> Vec<Disc>) -> Tracker {
        let mut tracker = Tracker::new(0.5);
        for step in 0..steps {
            let step = f32::from(step);
            FEW_BEAMS.scan(&mut tracker, in_a_circle(step), &discs(step));
        }
        tracker
    }

    #[test]
    fn the_position_velocity_and_radius_of_a_disc_are_estimated_from_a_few_beams() {
        let disc = |step: f32| Disc { x: 6.0 - 0.3 * step, y: 2.0 + 0.2 * step, radius: 0.9 };
        let tracker = track(12, |step| vec![disc(step)]);
        let moving: Vec<_> = tracker.moving(OBSERVED_TURN_SIGNIFICANCE).collect();
        let [(found, Motion { velocity, turn })] = moving[..] else { panic!("one disc moves: {moving:?}") };
        let truth = disc(11.0);
        assert!((found.x - truth.x).abs() < 0.2 && (found.y - truth.y).abs() < 0.2, "{found:?}, {truth:?}");
        assert!((velocity.0 + 0.3).abs() < 0.05 && (velocity.1 - 0.2).abs() < 0.05, "{velocity:?}");
        assert!((found.radius - 0.9).abs() < 0.2, "{found:?}");
        assert!(turn.abs() < 0.02, "{turn}");
    }

    #[test]
    fn a_disc_is_not_lost_while_no_beam_hits_it() {
        let disc = |step: f32| Disc { x: 9.0 - 0.3 * step, y: 2.0 + 0.2 * step, radius: 0.9 };
        // Something in front of the disc hides it in the last steps.
        let screen = |step: f32| Disc { x: disc(step).x - 1.8, y: disc(step).y - 0.4, radius: 1.0 };
        let tracker =
            track(13, |step| if step < 10.0 { vec![disc(step)] } else { vec![disc(step), screen(step)] });
        let truth = disc(12.0);
        let hidden = tracker.tracks.iter().find(|track| track.missed >= 3);
        let found = hidden.map(|track| (track.disc.x - truth.x).hypot(track.disc.y - truth.y));
        assert!(found.is_some_and(|error| error < 0.5), "{found:?}: {:?}", tracker.tracks);
    }

    #[test]
    fn walls_posts_and_rocks_do_not_move_as_the_robot_drives_past() {
        let posts = [(3.0, 3.0, 0.7), (-2.0, -4.0, 0.7), (7.0, -1.0, 0.7), (-11.5, 7.0, 0.7)];
        // Three rocks: two pairs of overlapping discs, and a single disc.
        let rocks =
            [(2.5, -7.0, 1.5), (4.2, -7.6, 1.1), (-8.5, -6.0, 1.8), (-9.0, -3.5, 1.2), (1.0, 11.5, 1.6)];
        let discs: Vec<Disc> =
            posts.into_iter().chain(rocks).map(|(x, y, radius)| Disc { x, y, radius }).collect();
        for lidar in [FEW_BEAMS, Lidar(72, TAU), Lidar(72, 0.75 * TAU)] {
            let mut tracker = Tracker::new(0.5);
            for step in 0..130_u8 {
                lidar.scan(&mut tracker, in_a_circle(step.into()), &discs);
                let moving: Vec<_> = tracker.moving(OBSERVED_TURN_SIGNIFICANCE).collect();
                assert!(moving.is_empty(), "{} beams, step {step}: {moving:?}", lidar.0);
            }
        }
    }

    #[test]
    fn a_robot_at_rest_sees_that_an_approaching_or_receding_disc_moves() {
        for (x, speed) in [(4.0, 0.3), (9.0, -0.2)] {
            let mut tracker = Tracker::new(0.5);
            for step in 0..14_u8 {
                let disc = Disc { x: x + speed * f32::from(step), y: 0.3, radius: 0.9 };
                FEW_BEAMS.scan(&mut tracker, ((0.0, 0.0), 0.0), &[disc]);
            }
            let moving: Vec<_> = tracker.moving(OBSERVED_TURN_SIGNIFICANCE).collect();
            let [(_, Motion { velocity, .. })] = moving[..] else { panic!("one disc moves: {moving:?}") };
            assert!((velocity.0 - speed).abs() < 0.05, "{velocity:?}");
        }
    }

    #[test]
    fn the_velocity_of_a_track_that_misfits_is_less_certain() {
        let variance = |misfit: f32| {
            let mut track = Track { misfit, ..Track::new((3.0, 0.0), 0.5, false) };
            let before = track.covariance[2][2];
            track.predict(0.5);
            track.covariance[2][2] - before
        };
        assert!((variance(MANOEUVRE_MISFIT + 1.0) / variance(0.1) - 1.0 - MANOEUVRE_GAIN).abs() < 0.01);
    }

    #[test]
    fn a_disc_that_drives_in_a_circle_is_followed() {
        // At 0.3 units a step, in a circle with a radius of 6 units.
        let disc = |step: f32| {
            let (sin, cos) = (0.05 * step).sin_cos();
            Disc { x: 2.0 + 6.0 * cos, y: 6.0 * sin - 2.0, radius: 0.9 }
        };
        let tracker = track(30, |step| vec![disc(step)]);
        let moving: Vec<_> = tracker.moving(OBSERVED_TURN_SIGNIFICANCE).collect();
        let [(found, Motion { velocity, .. })] = moving[..] else { panic!("one disc moves: {moving:?}") };
        let (truth, next) = (disc(29.0), disc(30.0));
        assert!((found.x - truth.x).hypot(found.y - truth.y) < 0.4, "{found:?}, {truth:?}");
        let error = (velocity.0 - (next.x - truth.x)).hypot(velocity.1 - (next.y - truth.y));
        assert!(error < 0.1, "{velocity:?}");
    }

    #[test]
    fn the_turn_of_a_disc_that_drives_in_a_circle_is_estimated() {
        for turn in [0.08, -0.08] {
            // At 0.4 units a step, in a circle with a radius of 5 units around the robot, which stands still.
            let disc = |step: f32| {
                let (sin, cos) = (turn * step).sin_cos();
                Disc { x: 5.0 * cos - 4.0, y: 5.0 * sin + 5.0, radius: 0.9 }
            };
            for steps in [30_u8, 40] {
                let mut tracker = Tracker::new(0.5);
                for step in 0..steps {
                    FEW_BEAMS.scan(&mut tracker, ((-4.0, 5.0), 0.0), &[disc(f32::from(step))]);
                }
                let moving: Vec<_> = tracker.moving(OBSERVED_TURN_SIGNIFICANCE).collect();
                let [(found, motion)] = moving[..] else { panic!("one disc moves: {moving:?}") };
                let (truth, later) = (disc(f32::from(steps) - 1.0), disc(f32::from(steps) + 9.0));
                assert!((found.x - truth.x).hypot(found.y - truth.y) < 0.3, "{found:?}, {truth:?}");
                assert!((motion.turn - turn).abs() < 0.025, "{motion:?}");
                let displacement = motion.displacement(10.0);
                let error = (found.x + displacement.0 - later.x).hypot(found.y + displacement.1 - later.y);
                assert!(error < 0.6, "{error} after ten steps; straight on, it would be 1.6");
            }
        }
    }

    #[test]
    fn a_scan_shows_surfaces_and_free_places() {
        let scan = |lidar: Lidar| {
            let mut tracker = Tracker::new(0.5);
            lidar.scan(&mut tracker, ((0.0, 0.0), 0.0), &[]);
            tracker.scans.pop_back().expect("a scan was added")
        };
        let rays = scan(FEW_BEAMS);
        let sight = |x: f32, y: f32, radius: f32| rays.sight((0, (x, y)), FEW_BEAMS.spacing_rad(), radius);
        assert_eq!(sight(HALF_ROOM - 0.1, 2.0, 1.0), Sight::Surface, "on the wall, between two beams");
        assert_eq!(sight(HALF_ROOM + 1.0, 2.0, 1.0), Sight::Unknown, "behind the wall");
        assert_eq!(sight(5.0, 0.7, 1.0), Sight::Free, "in the room, too large to fit between two beams");
        assert_eq!(sight(-5.0, -0.7, 1.0), Sight::Free, "between the last beam and the first");
        assert_eq!(sight(5.0, 0.7, 0.5), Sight::Unknown, "small enough to fit between them");
        let in_front = Lidar(24, 0.75 * TAU);
        let rays = scan(in_front);
        let sight = |x: f32, y: f32| rays.sight((0, (x, y)), in_front.spacing_rad(), 1.0);
        assert_eq!(sight(5.0, 0.5), Sight::Free);
        assert_eq!(sight(-5.0, 0.5), Sight::Unknown, "outside the field of view");
        for near in 0..24 {
            assert_eq!(
                rays.beside((5.0, 0.5), in_front.spacing_rad(), near),
                Some((12, 13)),
                "from ray {near}"
            );
        }
        assert_eq!(
            rays.beside((5.0, 0.5), in_front.spacing_rad(), 71),
            Some((12, 13)),
            "from a ray it lacks"
        );
        let out_of_range = Rays { max_range: 4.0, length: vec![4.0; 24], ..rays };
        let sight = |x: f32| out_of_range.sight((0, (x, 0.5)), in_front.spacing_rad(), 1.0);
        assert_eq!((sight(3.0), sight(5.0)), (Sight::Free, Sight::Unknown), "in range, and out of it");
    }

    #[test]
    fn a_disc_that_has_gone_is_forgotten() {
        let disc = Disc { x: 3.0, y: 3.0, radius: 1.0 };
        let has_track = |tracker: &Tracker| {
            tracker.tracks.iter().any(|track| (track.disc.x - 3.0).hypot(track.disc.y - 3.0) < 1.0)
        };
        assert!(has_track(&track(6, |_| vec![disc])));
        assert!(!has_track(&track(7, |step| if step < 6.0 { vec![disc] } else { Vec::new() })));
    }
}
