//! The observations of all arenas, and their layout: eq. (8) of the paper or sectors, then the readings of plugins' sensors.
//!
//! In: a scan, a pose, a goal, and the readings of plugins' sensors. Out: one row of [`Observations`] per arena. The numbers
//! of the [`Encoding`] come first ([`wayfield_policy::observation`] lists them); each slice that a plugin has reserved in
//! the [`ObservationLayout`] follows, in the order of reservation.

use std::ops::Range;
use std::sync::Arc;

use bevy::prelude::*;
use serde::{Deserialize, Serialize};

pub use crate::policy::observation::{DISTANCE_SCALE_M, Encoding, RANGE_SCALE_M, width};

use super::{
    Arena, ArenaLayout, Clock, Episode, EstimatedPose, Goal, PathLengths, PendingReset, Pose, Scan, Streams,
    Twist,
};
use crate::drivers::sector_observer;
use crate::policy::observation::{self as encodings, Column, ObserverMemory, SectorObserver, Sensed};
use crate::random::{self, Stream};
use crate::scenario::Scenario;

/// The parts of an observation: the numbers of an encoding, then one named slice per plugin sensor.
///
/// Policies and run folders record the layout. A policy runs only with the layout that it was trained with.
#[derive(Resource, Clone, Debug, Default, PartialEq, Eq)]
pub struct ObservationLayout {
    /// The encoding of scan and goal.
    pub encoding: Encoding,
    slices: Vec<ObservationSlice>,
}

/// A named part of an observation, reserved by a sensor plugin.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObservationSlice {
    /// The sensor's name.
    pub name: String,
    /// The number of elements.
    pub width: usize,
}

/// The handle of a reserved slice: the elements of [`SensorReadings`] that belong to one sensor.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SensorSlice(Range<usize>);

/// The readings of plugins' sensors in one arena: `layout.extra_width()` numbers. They are copied into the observation
/// unchanged, so a sensor should scale them to the order of 1.
#[derive(Component, Clone, Debug, Default, PartialEq)]
pub struct SensorReadings(Vec<f32>);

impl SensorReadings {
    /// The readings of one sensor.
    ///
    /// # Panics
    /// If the slice is out of range, because it was reserved in another app.
    pub fn slice_mut(&mut self, slice: &SensorSlice) -> &mut [f32] {
        &mut self.0[slice.0.clone()]
    }

    /// All readings, in the layout's order.
    #[must_use]
    pub fn as_slice(&self) -> &[f32] {
        &self.0
    }

    pub(crate) fn zeros(width: usize) -> Self {
        Self(vec![0.0; width])
    }

    pub(crate) fn from_saved(readings: &[f32]) -> Self {
        Self(readings.to_vec())
    }
}

impl ObservationLayout {
    /// The numbers of `encoding`, followed by `slices`.
    #[must_use]
    pub(crate) fn new(encoding: Encoding, slices: Vec<ObservationSlice>) -> Self {
        Self { encoding, slices }
    }

    /// Reserves `width` numbers under `name`, after the previously reserved slices.
    ///
    /// # Panics
    /// If another sensor has the same name.
    pub(crate) fn reserve(&mut self, name: &str, width: usize) -> SensorSlice {
        assert!(
            self.slices.iter().all(|slice| slice.name != name),
            "two plugins add a sensor named `{name}`; rename one of them"
        );
        let start = self.extra_width();
        self.slices.push(ObservationSlice { name: name.into(), width });
        SensorSlice(start..start + width)
    }

    /// The slices of plugins' sensors, in the order of reservation.
    #[must_use]
    pub fn slices(&self) -> &[ObservationSlice] {
        &self.slices
    }

    /// The number of elements that plugins' sensors add.
    #[must_use]
    pub fn extra_width(&self) -> usize {
        self.slices.iter().fold(0, |sum, slice| sum.saturating_add(slice.width))
    }

    /// The length of an observation with `beams` LIDAR beams.
    #[must_use]
    pub fn width(&self, beams: usize) -> usize {
        self.encoding.width(beams).saturating_add(self.extra_width())
    }

    /// A description of entry `column` of an observation with `beams` LIDAR beams, for messages.
    #[must_use]
    pub(crate) fn describe_column(&self, column: usize, beams: usize) -> String {
        if let Some(beyond) = column.checked_sub(self.encoding.width(beams)) {
            return self.describe_reading(beyond);
        }
        if let Some(sectors) = self.encoding.sectors() {
            let Some(Column { quantity, sector }) = sectors.columns().nth(column) else {
                return "outside the layout".into();
            };
            let of_sector = sector.map(|sector| format!(" of sector {sector}")).unwrap_or_default();
            return format!("{quantity:?}{of_sector}");
        }
        match column.checked_sub(beams) {
            None => format!("d_{}, a range", column + 1),
            Some(0) => "phi_0, the goal's bearing".into(),
            Some(1) => "d_g, the goal's distance".into(),
            Some(2) => "d_o, the smallest range".into(),
            Some(_) => "n, the index of the nearest beam".into(),
        }
    }

    /// A description of entry `index` of the readings of plugins' sensors.
    fn describe_reading(&self, mut index: usize) -> String {
        for ObservationSlice { name, width } in &self.slices {
            if index < *width {
                return format!("entry {index} of sensor `{name}`");
            }
            index -= width;
        }
        "outside the layout".into()
    }
}

/// The fraction of moving things that predictions leave out (`prediction_dropout` of a preset), 0 to 1.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq)]
pub struct PredictionDropout(pub f32);

/// The scans that an arena's robot remembers for its observation by sectors; none for the paper's observation.
#[derive(Component, Clone, Debug, Default, PartialEq)]
pub struct ScanMemory {
    sectors: Option<Box<SectorObserver>>,
    /// The scenario that the observer was made for.
    scenario: Option<Arc<Scenario>>,
}

impl ScanMemory {
    /// Forgets all scans, and takes in the first one after the robot was placed in `scenario`. `pose` is the robot's estimate
    /// of its pose ([`EstimatedPose`]).
    pub fn begin(
        &mut self,
        encoding: Encoding,
        scenario: &Arc<Scenario>,
        scan: &Scan,
        pose: &Pose,
        twist: &Twist,
    ) {
        self.forget(encoding, scenario);
        self.sense(scan, pose, twist);
    }

    /// Forgets all scans.
    fn forget(&mut self, encoding: Encoding, scenario: &Arc<Scenario>) {
        self.fit(encoding, scenario);
        if let Some(sectors) = &mut self.sectors {
            sectors.reset();
        }
    }

    /// Makes predictions leave out a fraction of the moving things that the robot sees, until it forgets all scans. The choice
    /// depends on the stream's state and on the clock, but draws nothing from the stream, so that everything else is the same
    /// with and without dropout.
    fn hide_predictions(
        &mut self,
        PredictionDropout(fraction): PredictionDropout,
        stream: &Stream,
        clock: Clock,
    ) {
        if let Some(sectors) = &mut self.sectors
            && fraction > 0.0
        {
            sectors.hide_predictions(fraction, random::derived_seed(stream, "predictions", clock.0));
        }
    }

    /// Takes in the scan after a control step.
    fn sense(&mut self, scan: &Scan, pose: &Pose, twist: &Twist) {
        if let Some(sectors) = &mut self.sectors {
            sectors.sense(&Sensed {
                ranges_m: &scan.ranges_m,
                pose: (pose.x_m, pose.y_m, pose.heading_rad),
                twist: (twist.v_m_s, twist.w_rad_s),
            });
        }
    }

    /// Makes an observer for the robot of `scenario`, unless the present one fits. Removes it if `encoding` needs none.
    fn fit(&mut self, encoding: Encoding, scenario: &Arc<Scenario>) {
        let Some(sectors) = encoding.sectors() else {
            self.sectors = None;
            return;
        };
        let fits = |old: &Arc<Scenario>| {
            let (a, b) = (&**old, &**scenario);
            Arc::ptr_eq(old, scenario) || (&a.robot, &a.lidar, &a.task) == (&b.robot, &b.lidar, &b.task)
        };
        let is_fitting = self.scenario.as_ref().is_some_and(fits);
        if !is_fitting || self.sectors.as_ref().is_none_or(|observer| observer.layout() != sectors) {
            self.sectors = Some(Box::new(sector_observer(sectors, scenario)));
        }
        self.scenario = Some(scenario.clone());
    }

    /// The observer; none for the paper's observation.
    pub(crate) fn observer(&self) -> Option<&SectorObserver> {
        self.sectors.as_deref()
    }

    /// What the observer remembers, for checkpoints.
    pub(crate) fn observer_memory(&self) -> ObserverMemory {
        self.sectors.as_ref().map(|sectors| sectors.memory().clone()).unwrap_or_default()
    }

    /// Restores what the observer remembered when a checkpoint was written. It must fit `encoding`.
    pub(crate) fn restore(
        &mut self,
        encoding: Encoding,
        scenario: &Arc<Scenario>,
        observer_memory: &ObserverMemory,
        twist: &Twist,
    ) {
        self.fit(encoding, scenario);
        if let Some(sectors) = &mut self.sectors {
            sectors.restore(observer_memory, (twist.v_m_s, twist.w_rad_s));
        }
    }
}

/// Writes the observation of one arena into `row`. `pose` is the robot's estimate of its pose ([`EstimatedPose`]).
///
/// A row whose length differs from the layout's is filled with zeros, and so are the numbers of an `encoding` by sectors in an
/// arena that has not [begun](ScanMemory::begin) an episode with it.
pub fn encode(
    encoding: Encoding,
    memory: &ScanMemory,
    scan: &Scan,
    (pose, goal): (&Pose, &Goal),
    readings: &SensorReadings,
    row: &mut [f32],
) {
    let width = encoding.width(scan.ranges_m.len());
    if width + readings.0.len() != row.len() {
        // Happens with the paper's encoding in scenario sets with different LIDARs. Only classical drivers, which read no rows,
        // drive there.
        row.fill(0.0);
        return;
    }
    let (encoded, extra) = row.split_at_mut(width);
    let (bearing_rad, distance_m) = (pose.bearing_rad(goal), pose.distance_m(goal));
    match (encoding.sectors(), &memory.sectors) {
        (None, _) => encodings::encode(encoding, &scan.ranges_m, bearing_rad, distance_m, encoded),
        (Some(layout), Some(sectors)) if sectors.layout() == layout => {
            sectors.encode((bearing_rad, distance_m), encoded);
        }
        (Some(_), _) => encoded.fill(0.0),
    }
    extra.copy_from_slice(&readings.0);
}

/// The observations of all arenas, row by row.
#[derive(Resource, Clone, Debug, Default)]
pub struct Observations {
    /// The length of a row.
    pub width: usize,
    /// The observations on which the next actions are based: arenas x width.
    pub current: Vec<f32>,
    /// The observations after the step and before any reset: arenas x width.
    pub next: Vec<f32>,
}

impl Observations {
    /// Allocates `arenas` rows of `width` numbers.
    pub(crate) fn resize(&mut self, arenas: usize, width: usize) {
        self.width = width;
        self.current = vec![0.0; arenas * width];
        self.next = vec![0.0; arenas * width];
    }

    /// The row of `arena` in `current`.
    #[must_use]
    pub fn row(&self, arena: usize) -> &[f32] {
        &self.current[arena * self.width..(arena + 1) * self.width]
    }

    /// The row of `arena` in `next`.
    #[must_use]
    pub fn next_row(&self, arena: usize) -> &[f32] {
        &self.next[arena * self.width..(arena + 1) * self.width]
    }
}

/// The components of an arena that its next observation is made of.
type Sensing = (
    &'static Arena,
    &'static Scan,
    (&'static EstimatedPose, &'static Twist),
    &'static Goal,
    &'static SensorReadings,
    &'static Episode,
    &'static mut ScanMemory,
);

/// `Sense`: encodes the observations after the step.
pub(super) fn observe_next(
    layout: Res<ObservationLayout>,
    mut observations: ResMut<Observations>,
    mut arenas: Query<Sensing>,
) {
    let width = observations.width;
    // Includes inactive arenas, because `current` and `next` are swapped after every step.
    for (arena, scan, (estimate, twist), goal, readings, episode, mut memory) in &mut arenas {
        let row = &mut observations.next[arena.0 * width..][..width];
        if !episode.inactive {
            memory.sense(scan, &estimate.0, twist);
        }
        encode(layout.encoding, &memory, scan, (&estimate.0, goal), readings, row);
    }
}

/// `Reset`: makes the next observations the current ones.
pub(super) fn advance(mut observations: ResMut<Observations>) {
    let observations = &mut *observations;
    std::mem::swap(&mut observations.current, &mut observations.next);
}

/// The components of an arena that its first observation and potential are made of.
type Observed = (
    &'static Arena,
    &'static ArenaLayout,
    &'static Scan,
    (&'static Pose, &'static EstimatedPose, &'static Twist),
    &'static Goal,
    &'static SensorReadings,
    &'static mut ScanMemory,
    (&'static mut PathLengths, &'static mut Episode),
    (&'static Streams, &'static Clock),
);

/// Schedule `Reset`: encodes the observations and computes the potentials of arenas with a pending reset.
pub(super) fn observe_first(
    (layout, dropout): (Res<ObservationLayout>, Res<PredictionDropout>),
    mut observations: ResMut<Observations>,
    reward: Res<super::RewardConfig>,
    mut arenas: Query<Observed>,
) {
    let width = observations.width;
    for (
        arena,
        arena_layout,
        scan,
        (pose, estimate, twist),
        goal,
        readings,
        mut memory,
        (mut paths, mut episode),
        (streams, clock),
    ) in &mut arenas
    {
        if episode.pending_reset != PendingReset::None {
            let row = &mut observations.current[arena.0 * width..][..width];
            if episode.pending_reset.moves_robot() {
                memory.forget(layout.encoding, &arena_layout.written);
                memory.hide_predictions(*dropout, &streams.sensor, *clock);
                memory.sense(scan, &estimate.0, twist);
            }
            encode(layout.encoding, &memory, scan, (&estimate.0, goal), readings, row);
            let scale = reward.scale(arena_layout.robot_unit_m);
            let attracting_m = paths.distance_m(&reward, arena_layout, pose, goal);
            episode.potential = reward.potential(scale * attracting_m, scale * scan.nearest_m);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::Lidar;

    #[test]
    fn an_observation_is_the_papers_numbers_followed_by_the_sensors_slices() {
        let mut layout = ObservationLayout::default();
        layout.reserve("speed", 2);
        let bumper = layout.reserve("bumper", 1);
        assert_eq!(layout.width(2), 2 + 4 + 3);
        let mut readings = SensorReadings::zeros(layout.extra_width());
        readings.slice_mut(&bumper)[0] = 7.0;
        let scan = Scan { ranges_m: vec![3.5, 0.7], nearest_m: 0.7, ..Scan::default() };
        let pose = Pose { x_m: 1.0, y_m: 0.0, heading_rad: 0.0 };
        let goal = Goal { x_m: 1.0, y_m: -2.0 };
        let mut row = vec![f32::NAN; layout.width(2)];
        encode(Encoding::Raw, &ScanMemory::default(), &scan, (&pose, &goal), &readings, &mut row);
        assert_eq!(row, [3.5, 0.7, -core::f32::consts::FRAC_PI_2, 2.0, 0.7, 1.0, 0.0, 0.0, 7.0]);
        assert_eq!(layout.describe_column(3, 2), "d_g, the goal's distance");
        assert_eq!(layout.describe_column(8, 2), "entry 0 of sensor `bumper`");
    }

    #[test]
    fn a_row_is_encoded_even_if_the_arena_has_begun_no_episode_with_the_encoding() {
        // An evaluator reuses arenas, possibly with another encoding, and some of them may be inactive.
        let (beams, sectors) = (
            360,
            Encoding::Sectors { count: 4, earlier_steps: 1, free_paths: false, predicted_paths: false },
        );
        let scenario =
            Arc::new(Scenario { lidar: Lidar { beams, ..Lidar::default() }, ..Scenario::default() });
        let scan = Scan { ranges_m: vec![1.0; beams], nearest_m: 1.0, ..Scan::default() };
        let (pose, goal) = (Pose::default(), Goal { x_m: 1.0, y_m: 0.0 });
        let row = |encoding: Encoding, memory: &ScanMemory| {
            let mut row = vec![f32::NAN; encoding.width(beams)];
            encode(encoding, memory, &scan, (&pose, &goal), &SensorReadings::default(), &mut row);
            row
        };
        let mut memory = ScanMemory::default();
        assert!(row(sectors, &memory).iter().all(|value| *value == 0.0));
        let paper = row(Encoding::Raw, &memory);
        memory.begin(sectors, &scenario, &scan, &pose, &Twist::default());
        assert!(row(sectors, &memory)[..4].iter().all(|value| *value > 0.0), "it sees walls all around");
        assert_eq!(row(Encoding::Raw, &memory), paper);
    }

    #[test]
    #[should_panic(expected = "two plugins add a sensor named `speed`")]
    fn two_sensors_with_the_same_name_are_rejected() {
        let mut layout = ObservationLayout::default();
        layout.reserve("speed", 1);
        layout.reserve("speed", 1);
    }
}
