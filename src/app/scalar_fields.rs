//! Scalar fields over the plane: the potential, and the network's value, for a robot anywhere in the followed arena.
//!
//! In: the followed arena, read-only. Out: two grids ([`ScalarFields`]). A field is computed only if its overlay is shown, only
//! when its inputs have changed, and at most four times a second.

use std::sync::Arc;

use bevy::prelude::*;
use bevy::time::Real;

use super::CurrentViewState;
use super::commands::SessionMode;
use super::scene::ScalarField;
use super::session::{ActiveMode, OpenedFiles};
use crate::agent::{ActionSource, ActionSources, ActiveLearner};
use crate::learning::QNetwork;
use crate::scenario::{Scenario, enclosure_distance, inner_wall_distance};
use crate::sim::Probe;
use crate::task::{
    Arena, Clock, CurrentScenario, Goal, ObservationLayout, Pose, RewardConfig, Scan, SensorReadings,
    observation,
};

/// Number of grid points along the longer side.
const POINTS: usize = 56;
/// Minimum time between two computations, in s.
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
    /// Inputs of the present fields.
    inputs: Option<FieldInputs>,
}

/// Everything that the fields depend on.
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
    opened_policy: Option<String>,
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

/// Computes the fields whose overlays are shown.
#[expect(clippy::too_many_arguments, reason = "a system's parameters are what it reads")]
pub(super) fn compute_scalar_fields(
    view_state: Res<CurrentViewState>,
    mode: Res<ActiveMode>,
    opened: Res<OpenedFiles>,
    scenario: Res<CurrentScenario>,
    reward: Res<RewardConfig>,
    layout: Res<ObservationLayout>,
    learner: Res<ActiveLearner>,
    sources: Res<ActionSources>,
    time: Res<Time<Real>>,
    probe: Option<Probe>,
    arenas: Query<(&Arena, &Pose, &Goal, &Clock, &SensorReadings)>,
    mut fields: ResMut<ScalarFields>,
) {
    let Some(probe) = probe else { return };
    let mode = mode.mode();
    let asked = view_state.0.overlays;
    let wanted = view_state.0.followed;
    let as_a_grid = view_state.0.grid && mode == SessionMode::Train;
    if as_a_grid || !(asked.potential || asked.value) {
        fields.potential = None;
        fields.value = None;
        fields.inputs = None;
        return;
    }
    let followed = arenas.iter().find(|(arena, ..)| arena.0 == wanted).or_else(|| arenas.iter().next());
    let Some((arena, pose, goal, clock, readings)) = followed else { return };
    let Some(scan_from) = probe.of(arena.0) else { return };
    let now_s = time.elapsed_secs_f64();
    let inputs = FieldInputs {
        potential: asked.potential,
        value: asked.value,
        scenario: scenario.0.clone(),
        mode,
        arena: arena.0,
        goal: *goal,
        heading_rad: pose.heading_rad,
        clock: *clock,
        gradient_steps: learner.0.gradient_steps(),
        opened_policy: opened.policy.as_ref().map(|(name, _)| name.clone()),
    };
    let before = fields.inputs.as_ref();
    let is_current = before.is_some_and(|before| *before == inputs);
    let more =
        before.is_none_or(|before| inputs.potential && !before.potential || inputs.value && !before.value);
    if is_current || (!more && now_s - fields.computed_at_s < MIN_INTERVAL_S) {
        return;
    }
    fields.inputs = Some(inputs);
    fields.computed_at_s = now_s;
    fields.version += 1;
    let version = fields.version;
    let scenario = &*scenario.0;
    let grid = FieldGrid::over(scenario);
    // One scan per point serves both fields.
    let mut scan = Scan::default();
    let mut observations = Vec::new();
    let mut potentials = Vec::new();
    let width = layout.width(scenario.lidar.beams);
    for Vec2 { x: x_m, y: y_m } in grid.points_m() {
        let there = Pose { x_m, y_m, heading_rad: pose.heading_rad };
        scan_from(&there, &mut scan);
        // From outside or inside a wall the beams may see far, so the floor is checked separately.
        let free = scan.nearest_m >= scenario.task.collision_range_m && is_floor(scenario, vec2(x_m, y_m));
        let potential = reward.potential(there.distance_m(goal), scan.nearest_m).total();
        potentials.push(if free { potential } else { f32::NAN });
        if asked.value {
            let start = observations.len();
            observations.resize(start + width, 0.0);
            observation::encode(layout.encoding, &scan, &there, goal, readings, &mut observations[start..]);
        }
    }
    fields.value = None;
    if asked.value {
        // The user has no network: the value of the policy in the other arena is shown instead.
        let policies = sources.arenas.iter().skip(arena.0).chain(&sources.arenas);
        let network = match mode {
            SessionMode::Train => Some(learner.0.network()),
            _ => policies.filter_map(network).next(),
        };
        fields.value = network.map(|network| {
            let mut values = values(network, &observations, potentials.len());
            for (value, potential) in values.iter_mut().zip(&potentials) {
                *value = if potential.is_nan() { f32::NAN } else { *value };
            }
            grid.field(values, version)
        });
    }
    fields.potential = asked.potential.then(|| grid.field(potentials, version));
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
        ActionSource::Manual(_) => None,
    }
}

/// max_a Q(s, a) of each of `n` observations: the value of acting greedily from there.
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
        let corners_m = vec![vec2(1.0, 0.0), vec2(5.0, 0.0), vec2(5.0, 1.0), vec2(3.0, 1.0), vec2(3.0, 2.0), vec2(1.0, 2.0)];
        let wall = Wall { corners_m: vec![vec2(1.0, 0.5), vec2(2.0, 0.5)], thickness_m: 0.1 };
        let scenario = Scenario {
            enclosure: Enclosure::Polygon { corners_m },
            walls: vec![wall],
            ..Scenario::default()
        };
        let grid = FieldGrid::over(&scenario);
        assert_eq!((grid.size, grid.min_m, grid.max_m), ([POINTS, POINTS / 2], [1.0, 0.0], [5.0, 2.0]));
        assert_eq!(grid.points_m().count(), POINTS * POINTS / 2);
        for vec2(point, floor) in
            [(vec2(2.0, 1.5), true), (vec2(4.0, 1.5), false), (vec2(1.5, 0.52), false), (vec2(1.5, 0.6), true)]
        {
            assert_eq!(is_floor(&scenario, point), floor, "{point:?}");
        }
    }
}
