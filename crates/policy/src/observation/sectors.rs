//! The layout of the observation by sectors, and the beams that each sector pools.
//!
//! Lengths are in units of the robot: 1 is the distance from its centre at which it collides. So one policy fits robots of any
//! size and speed, and LIDARs with any number of beams and any field of view.
//!
//! | columns | meaning |
//! |---|---|
//! | 0 .. S-1 | nearness of the nearest thing in each of S sectors, 0 (nothing in sight) to 1 (contact); sector 0 is centred straight ahead, then counterclockwise |
//! | S .. 2S-1 | what has moved: the nearness now minus that of the earlier scan, moved into the present frame by odometry, times 4; -1 to 1, positive for what approaches, 0 where unknown or far away. Absent without an earlier scan |
//! | then S | nearness of what the robot would collide with if it drove straight on in the direction of a sector's centre, whatever its heading; 0 if that path is free. Absent without free paths |
//! | then S | the same for a robot at its highest speed, if moving things keep their speeds and turning rates. Absent without predicted paths |
//! | then 4 | direction of the goal (cosine and sine of its bearing), the nearness of its edge, and a quarter of ln(1 + the distance to its edge) |
//! | then 2 | the robot's speed and turning rate, in units of its highest |
//! | then 2 | the longest distance that the robot drives in a control step, in units of the robot, and its largest turn in a control step, in rad |
//! | then 1 | how soon something hits the robot if it waits: the nearness of the distance that it could drive until then at its highest speed; 0 if nothing hits it. Absent without predicted paths |
//!
//! The nearness of a thing x units away from the body is 1 / (1 + x / 2).

use std::f32::consts::{PI, TAU};
use std::ops::RangeInclusive;

use super::Quantity;

/// The range of the number of sectors.
const COUNT: RangeInclusive<u16> = 4..=360;
/// The largest number of control steps to the earlier scan.
const MAX_EARLIER_STEPS: u8 = 20;
/// The distance at which the nearness is one half, in units of the robot.
const HALF_NEARNESS: f32 = 2.0;
/// The number of columns after those of the sectors, without the one for waiting.
pub(super) const OTHER_COLUMNS: usize = 8;

/// The layout of an observation by sectors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SectorLayout {
    /// Number of sectors of a full turn.
    pub count: u16,
    /// Number of control steps to the earlier scan; 0 for none.
    pub earlier_steps: u8,
    /// Whether there is a column for each sector's free path.
    pub free_paths: bool,
    /// Whether there is a column for each sector's predicted path (the free path if moving things keep their speeds and
    /// turning rates), and one for waiting. They need an earlier scan.
    pub predicted_paths: bool,
}

/// The meaning of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Column {
    /// What the column measures.
    pub quantity: Quantity,
    /// The sector in which it is measured, if the quantity has a column per sector.
    pub sector: Option<usize>,
}

impl SectorLayout {
    /// The length of an observation.
    #[must_use]
    pub const fn width(self) -> usize {
        let predicted = self.predicted_paths as usize;
        let per_sector = 1 + (self.earlier_steps > 0) as usize + self.free_paths as usize + predicted;
        per_sector * self.count as usize + OTHER_COLUMNS + predicted
    }

    /// The number of columns for changes.
    pub(super) fn changes(self) -> usize {
        if self.earlier_steps > 0 { usize::from(self.count) } else { 0 }
    }

    /// Whether the observation `row` shows something that moves: whether its predicted paths differ from its free paths. If the
    /// layout lacks one of them, that is unknown, and the result is true.
    ///
    /// # Panics
    /// `row` is shorter than an observation of this layout.
    #[must_use]
    pub fn shows_motion(self, row: &[f32]) -> bool {
        if !(self.free_paths && self.predicted_paths) {
            return true;
        }
        let count = usize::from(self.count);
        let paths = &row[count + self.changes()..][..2 * count];
        paths[..count] != paths[count..]
    }

    /// The direction of the centre of a sector relative to the heading, counterclockwise positive, in rad, in (-pi, pi].
    #[must_use]
    pub fn angle_rad(self, sector: usize) -> f32 {
        let angle = sector as f32 * (TAU / f32::from(self.count));
        if angle > PI { angle - TAU } else { angle }
    }

    /// The meaning of each column, in their order.
    pub fn columns(self) -> impl Iterator<Item = Column> {
        let count = usize::from(self.count);
        let if_present = |is_present: bool| if is_present { count } else { 0 };
        let sectors = [
            (Quantity::Nearness, count),
            (Quantity::NearnessChange, self.changes()),
            (Quantity::CollisionNearness, if_present(self.free_paths)),
            (Quantity::PredictedNearness, if_present(self.predicted_paths)),
        ];
        let others = [
            Quantity::GoalCosine,
            Quantity::GoalSine,
            Quantity::GoalNearness,
            Quantity::GoalLogDistance,
            Quantity::Speed,
            Quantity::TurningRate,
            Quantity::StepLength,
            Quantity::StepTurn,
        ];
        let of_sectors = sectors.into_iter().flat_map(|(quantity, sectors)| {
            (0..sectors).map(move |sector| Column { quantity, sector: Some(sector) })
        });
        let waiting = self.predicted_paths.then_some(Quantity::WaitingNearness);
        of_sectors.chain(others.into_iter().chain(waiting).map(|quantity| Column { quantity, sector: None }))
    }

    /// The mirror image of an observation: column k of the image is column `.0` of the original, times `.1`.
    #[must_use]
    pub fn mirrored_columns(self) -> Vec<(usize, f32)> {
        let count = usize::from(self.count);
        let image = |(k, column): (usize, Column)| match column {
            Column { sector: Some(sector), .. } => (k - sector + (count - sector) % count, 1.0),
            Column { quantity: Quantity::GoalSine | Quantity::TurningRate, .. } => (k, -1.0),
            _ => (k, 1.0),
        };
        self.columns().enumerate().map(image).collect()
    }

    /// Checks that the numbers are in range, and that predicted paths have an earlier scan.
    pub(super) fn check(self) -> Result<(), String> {
        let (least, most) = (COUNT.start(), COUNT.end());
        if !COUNT.contains(&self.count) {
            return Err(format!("has a count of {}; help: give {least} to {most} sectors", self.count));
        }
        if self.earlier_steps > MAX_EARLIER_STEPS {
            return Err(format!(
                "has an earlier_steps of {}; help: give 1 to {MAX_EARLIER_STEPS} control steps, or 0 for no earlier scan",
                self.earlier_steps
            ));
        }
        if self.predicted_paths && self.earlier_steps == 0 {
            return Err("has predicted_paths, but an earlier_steps of 0; help: give 1 or more".into());
        }
        Ok(())
    }
}

/// The nearness of a thing at distance `x` from the body, in units of the robot; 1 for a contact.
#[must_use]
pub(super) fn nearness(x: f32) -> f32 {
    1.0 / (1.0 + x.max(0.0) / HALF_NEARNESS)
}

/// The distance of a thing with this `nearness` from the body, in units of the robot.
#[must_use]
pub(super) const fn distance_at(nearness: f32) -> f32 {
    HALF_NEARNESS * (1.0 / nearness - 1.0)
}

/// The LIDAR of a robot, as far as it matters for pooling its beams.
#[derive(Clone, Debug, PartialEq)]
pub struct LidarBeams {
    /// The direction of each beam relative to the heading, counterclockwise positive, in rad; in counterclockwise order.
    pub angles_rad: Vec<f32>,
    /// The angle between neighbouring beams, in rad.
    pub spacing_rad: f32,
    /// The maximum range, in m. A beam that reports it has hit nothing.
    pub max_range_m: f32,
}

/// What an observation is scaled by: sizes and limits of the robot, and the goal's radius.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyScale {
    /// The unit of length, in m: the distance from the robot's centre at which it collides.
    pub unit_m: f32,
    /// The extent of the body along each beam, in m: a range of at most this is a contact.
    pub extents_m: Vec<f32>,
    /// The highest speed, in m/s.
    pub max_speed_m_s: f32,
    /// The highest turning rate, in rad/s.
    pub max_turn_rad_s: f32,
    /// The control period, in s.
    pub control_period_s: f32,
    /// The radius of the goal, in m.
    pub goal_radius_m: f32,
}

impl BodyScale {
    /// The longest distance that the robot drives in a control step, in units of the robot.
    pub(super) fn step_length(&self) -> f32 {
        self.max_speed_m_s * self.control_period_s / self.unit_m
    }
}

/// The sectors of each beam: the one that it points into, and others that no beam points into. Such a sector belongs to the beam
/// nearest to its centre, if that beam is less than the angle between neighbouring beams away.
pub(super) fn sectors_of_beams(layout: SectorLayout, lidar: &LidarBeams) -> Vec<Vec<usize>> {
    let count = usize::from(layout.count);
    let per_sector = TAU / count as f32;
    let sector_of = |angle: f32| (angle / per_sector).round().rem_euclid(count as f32) as usize % count;
    let mut sectors: Vec<Vec<usize>> = lidar.angles_rad.iter().map(|&angle| vec![sector_of(angle)]).collect();
    let mut has_beam = vec![false; count];
    sectors.iter().for_each(|sectors| has_beam[sectors[0]] = true);
    for sector in (0..count).filter(|&sector| !has_beam[sector]) {
        let away = |angle: f32| {
            let difference = (angle - layout.angle_rad(sector)).rem_euclid(TAU);
            difference.min(TAU - difference)
        };
        let beams = lidar.angles_rad.iter().map(|&angle| away(angle)).enumerate();
        let nearest = beams.min_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((beam, _)) = nearest.filter(|(_, away)| *away < lidar.spacing_rad) {
            sectors[beam].push(sector);
        }
    }
    sectors
}
