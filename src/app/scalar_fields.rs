//! Scalar fields over the plane: the potential, and the network's state value, for a robot anywhere in the followed arena.
//!
//! In: the followed arena, read-only. Out: a grid for each overlay shown ([`ScalarFields`]). The grids are computed again when
//! their inputs have changed, at most four times a second, but at once when an overlay is switched on.

use std::sync::Arc;

use bevy::ecs::change_detection::Tick;
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy::time::Real;

use super::CurrentViewState;
use super::commands::SessionMode;
use super::scene::ScalarField;
use super::session::ActiveMode;
use crate::agent::{ActionSource, ActionSources, ActiveLearner};
use crate::learning::QNetwork;
use crate::scenario::{Scenario, enclosure_distance, inner_wall_distance};
use crate::sim::Probe;
use crate::task::{
    Arena, ArenaLayout, Clock, Goal, ObservationLayout, PathLengths, Pose, RewardConfig, Scan, ScanMemory,
    SensorReadings, Twist, observation,
};

/// Number of grid points along the longer side.
const POINTS: usize = 56;
/// Minimum time between two computations, in s, unless an overlay is switched on.
const MIN_INTERVAL_S: f64 = 0.25;

/// The fields whose overlays are shown.
#[derive(Resource, Default)]
pub struct ScalarFields {
    /// The potential U of eq. (4).
    pub potential: Option<Arc<ScalarField>>,
    /// The value V(s) = max_a Q(s, a).
    pub value: Option<Arc<ScalarField>>,
    version: u64,
    computed_at_s: f64,
    /// Inputs of the current fields.
    inputs: Option<FieldInputs>,
}

/// The inputs of the fields, compared to detect changes.
#[derive(Clone, PartialEq)]
struct FieldInputs {
    potential: bool,
    value: bool,
    scenario: Arc<Scenario>,
    mode: SessionMode,
    arena: usize,
    goal: Goal,
    heading_rad: f32,
    clock: Clock,
    gradient_steps: u64,
    /// When the action sources last changed, for example because another policy is tested.
    drivers_changed: Tick,
}

impl ScalarFields {
    /// Whether the fields must be computed at `now_s`: at once if an overlay was switched on, after an interval if another input
    /// has changed.
    fn needs_update(&self, inputs: &FieldInputs, now_s: f64) -> bool {
        let Some(before) = &self.inputs else { return true };
        let is_switched_on = inputs.potential && !before.potential || inputs.value && !before.value;
        before != inputs && (is_switched_on || now_s - self.computed_at_s >= MIN_INTERVAL_S)
    }
}

/// The grid of a field.
#[derive(Clone, Copy)]
struct FieldGrid {
    size: [usize; 2],
    min_m: [f32; 2],
    max_m: [f32; 2],
}

impl FieldGrid {
    /// A grid over the bounding box of the enclosure.
    fn over(scenario: &Scenario) -> Self {
        let (min, max) = scenario.enclosure.bounds_m();
        let (width_m, height_m) = (max.x - min.x, max.y - min.y);
        let longer = width_m.max(height_m);
        let points = |side: f32| ((POINTS as f32 * side / longer).round() as usize).max(2);
        Self { size: [points(width_m), points(height_m)], min_m: min.into(), max_m: max.into() }
    }

    /// Centres of the cells in m, row by row from the bottom.
    fn points_m(&self) -> impl Iterator<Item = Vec2> + '_ {
        let at = |k: usize, axis: usize| {
            let (min, max) = (self.min_m[axis], self.max_m[axis]);
            min + (max - min) * (k as f32 + 0.5) / self.size[axis] as f32
        };
        (0..self.size[1])
            .flat_map(move |row| (0..self.size[0]).map(move |column| vec2(at(column, 0), at(row, 1))))
    }

    fn field(&self, values: Vec<f32>, version: u64) -> Arc<ScalarField> {
        Arc::new(ScalarField { size: self.size, min_m: self.min_m, max_m: self.max_m, values, version })
    }
}

/// The parts of the world that the fields are computed from.
#[derive(SystemParam)]
pub(super) struct FieldSources<'w, 's> {
    view_state: Res<'w, CurrentViewState>,
    mode: Res<'w, ActiveMode>,
    reward: Res<'w, RewardConfig>,
    layout: Res<'w, ObservationLayout>,
    learner: Res<'w, ActiveLearner>,
    sources: Res<'w, ActionSources>,
    arenas: Query<
        'w,
        's,
        (
            &'static Arena,
            &'static ArenaLayout,
            &'static Pose,
            &'static Goal,
            &'static Clock,
            &'static SensorReadings,
        ),
    >,
}

impl FieldSources<'_, '_> {
    /// Whether any field is shown: its overlay is on, and the view is not the grid of all arenas.
    fn is_shown(&self) -> bool {
        let overlays = self.view_state.0.overlays;
        let is_grid = self.view_state.0.grid && self.mode.is_training();
        !is_grid && (overlays.potential || overlays.value)
    }

    /// The inputs of the fields in the followed arena, or else in the first one.
    fn inputs(&self) -> Option<(FieldInputs, &SensorReadings)> {
        let index = self.view_state.0.followed;
        let followed = self.arenas.iter().find(|(arena, ..)| arena.0 == index);
        let (arena, layout, pose, goal, clock, readings) = followed.or_else(|| self.arenas.iter().next())?;
        let overlays = self.view_state.0.overlays;
        let inputs = FieldInputs {
            potential: overlays.potential,
            value: overlays.value,
            scenario: layout.written.clone(),
            mode: self.mode.mode(),
            arena: arena.0,
            goal: *goal,
            heading_rad: pose.heading_rad,
            clock: *clock,
            gradient_steps: self.learner.0.gradient_steps(),
            drivers_changed: self.sources.last_changed(),
        };
        Some((inputs, readings))
    }

    /// The network that drives in `arena`. If none does, that of another arena.
    fn network(&self, arena: usize) -> Option<&QNetwork> {
        if self.mode.is_training() {
            return Some(self.learner.0.network());
        }
        let sources = &self.sources.arenas;
        sources.iter().skip(arena).chain(sources).filter_map(network).next()
    }
}

/// Computes the fields whose overlays are shown.
pub(super) fn compute_scalar_fields(
    sources: FieldSources,
    time: Res<Time<Real>>,
    probe: Option<Probe>,
    mut fields: ResMut<ScalarFields>,
) {
    if !sources.is_shown() {
        (fields.potential, fields.value, fields.inputs) = (None, None, None);
        return;
    }
    let (Some(probe), Some((inputs, readings))) = (probe, sources.inputs()) else { return };
    let Some(scan_from) = probe.of(inputs.arena) else { return };
    let now_s = time.elapsed_secs_f64();
    if !fields.needs_update(&inputs, now_s) {
        return;
    }
    let grid = FieldGrid::over(&inputs.scenario);
    let (potentials, observations) = sample(&grid, &inputs, &sources, readings, scan_from);
    let version = fields.version + 1;
    let network = if inputs.value { sources.network(inputs.arena) } else { None };
    *fields = ScalarFields {
        value: network.map(|network| grid.field(masked_values(network, &observations, &potentials), version)),
        potential: inputs.potential.then(|| grid.field(potentials, version)),
        version,
        computed_at_s: now_s,
        inputs: Some(inputs),
    };
}

/// The potential at each point of `grid`, NaN where the robot cannot be; and, if the value is shown, the observations there.
fn sample(
    grid: &FieldGrid,
    inputs: &FieldInputs,
    sources: &FieldSources,
    readings: &SensorReadings,
    scan_from: impl Fn(&Pose, &mut Scan),
) -> (Vec<f32>, Vec<f32>) {
    let (scenario, goal) = (&*inputs.scenario, &inputs.goal);
    let width = sources.layout.width(scenario.lidar.beams);
    let (mut potentials, mut observations) = (Vec::new(), Vec::new());
    let layout =
        sources.arenas.iter().find(|(arena, ..)| arena.0 == inputs.arena).map(|(_, layout, ..)| layout);
    let mut paths = PathLengths::default();
    // One scan per point serves both fields.
    let (mut scan, mut memory) = (Scan::default(), ScanMemory::default());
    for Vec2 { x: x_m, y: y_m } in grid.points_m() {
        let pose = Pose { x_m, y_m, heading_rad: inputs.heading_rad };
        scan_from(&pose, &mut scan);
        // Outside the enclosure or inside a wall, beams may be long, so the floor is checked separately.
        let free = scan.nearest_m >= scenario.sure_collision_m() && is_floor(scenario, vec2(x_m, y_m));
        let attracting_m = layout.map_or_else(
            || pose.distance_m(goal),
            |layout| paths.distance_m(&sources.reward, layout, &pose, goal),
        );
        let scale = sources.reward.scale(scenario.robot_unit_m());
        let potential = sources.reward.potential(scale * attracting_m, scale * scan.nearest_m).total();
        potentials.push(if free { potential } else { f32::NAN });
        if inputs.value {
            let start = observations.len();
            observations.resize(start + width, 0.0);
            let row = &mut observations[start..];
            let encoding = sources.layout.encoding;
            memory.begin(encoding, &inputs.scenario, &scan, &pose, &Twist::default());
            observation::encode(encoding, &memory, &scan, (&pose, goal), readings, row);
        }
    }
    (potentials, observations)
}

/// The value of each observation; NaN where the potential is NaN.
fn masked_values(network: &QNetwork, observations: &[f32], potentials: &[f32]) -> Vec<f32> {
    let mut values = values(network, observations, potentials.len());
    for (value, potential) in values.iter_mut().zip(potentials) {
        *value = if potential.is_nan() { f32::NAN } else { *value };
    }
    values
}

/// Whether a point lies inside the enclosure and outside the inner walls.
fn is_floor(scenario: &Scenario, point_m: Vec2) -> bool {
    enclosure_distance(&scenario.enclosure, point_m) > 0.0
        && scenario.walls.iter().all(|wall| inner_wall_distance(wall, point_m) > 0.0)
}

/// The network of an action source, if it has one.
fn network(source: &ActionSource) -> Option<&QNetwork> {
    match source {
        ActionSource::Policy(network) => Some(network),
        ActionSource::Manual(_) | ActionSource::Driver(_) => None,
    }
}

/// The state values: max_a Q(s, a) for each of `n` observations.
fn values(network: &QNetwork, observations: &[f32], n: usize) -> Vec<f32> {
    let mut q_values = Vec::new();
    network.q_values(observations, n, &mut q_values);
    let actions = network.shape().actions.max(1);
    q_values.chunks_exact(actions).map(|row| row.iter().copied().fold(f32::NEG_INFINITY, f32::max)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::{Enclosure, Wall};

    #[test]
    fn the_grid_covers_the_bounding_box_and_only_points_between_the_walls_are_floor() {
        let corners_m = vec![
            vec2(1.0, 0.0),
            vec2(5.0, 0.0),
            vec2(5.0, 1.0),
            vec2(3.0, 1.0),
            vec2(3.0, 2.0),
            vec2(1.0, 2.0),
        ];
        let wall =
            Wall { corners_m: vec![vec2(1.0, 0.5), vec2(2.0, 0.5)], thickness_m: 0.1, ..Wall::default() };
        let scenario = Scenario {
            enclosure: Enclosure::Polygon { corners_m },
            walls: vec![wall],
            ..Scenario::default()
        };
        let grid = FieldGrid::over(&scenario);
        assert_eq!((grid.size, grid.min_m, grid.max_m), ([POINTS, POINTS / 2], [1.0, 0.0], [5.0, 2.0]));
        assert_eq!(grid.points_m().count(), POINTS * POINTS / 2);
        for (point, floor) in [
            (vec2(2.0, 1.5), true),
            (vec2(4.0, 1.5), false),
            (vec2(1.5, 0.52), false),
            (vec2(1.5, 0.6), true),
        ] {
            assert_eq!(is_floor(&scenario, point), floor, "{point:?}");
        }
    }
}
