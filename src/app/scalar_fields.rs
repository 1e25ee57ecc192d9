//! The fields over the plane: what the potential, and what the network's value, would be if the robot stood elsewhere.
//!
//! In: the followed arena, read only. Out: two grids ([`ScalarFields`]). Only what the desk asks for is worked out, only when
//! what it depends on has changed, and the value at most a few times a second.

use std::sync::Arc;

use bevy::prelude::*;
use bevy::time::Real;

use super::CurrentViewState;
use super::commands::SessionMode;
use super::scene::ScalarField;
use super::session::Session;
use crate::agent::{ActionSource, ActionSources, ActiveLearner};
use crate::learning::QNetwork;
use crate::scenario::{Scenario, enclosure_distance, inner_wall_distance};
use crate::sim::Probe;
use crate::task::{
    Arena, Clock, CurrentScenario, Goal, ObservationLayout, Pose, RewardConfig, Scan, SensorReadings,
    observation,
};

/// Grid points along the longer side.
const POINTS: usize = 56;
/// The value is worked out anew at most every so many seconds.
const EVERY_S: f64 = 0.25;

/// The fields that were asked for.
#[derive(Resource, Default)]
pub struct ScalarFields {
    /// U of eq. (4).
    pub potential: Option<Arc<ScalarField>>,
    /// V(s).
    pub value: Option<Arc<ScalarField>>,
    version: u64,
    computed_at_s: f64,
    /// Of what they are.
    of: Option<Of>,
}

/// What the fields depend on: as long as it is the same, so are they.
#[derive(Clone, PartialEq)]
struct Of {
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

/// What the fields are over.
#[derive(Clone, Copy)]
struct FieldGrid {
    size: [usize; 2],
    min_m: [f32; 2],
    max_m: [f32; 2],
}

impl FieldGrid {
    fn over(scenario: &Scenario) -> Self {
        let (min, max) = scenario.enclosure.bounds_m();
        let (width_m, height_m) = (max.x - min.x, max.y - min.y);
        let longer = width_m.max(height_m);
        let points = |side: f32| ((POINTS as f32 * side / longer).round() as usize).max(2);
        Self { size: [points(width_m), points(height_m)], min_m: min.into(), max_m: max.into() }
    }

    /// The middle of each cell, row by row from the bottom.
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

/// Works out what the desk asks for.
#[expect(clippy::too_many_arguments, reason = "a system's parameters are what it reads")]
pub(super) fn compute_scalar_fields(
    view_state: Res<CurrentViewState>,
    session: Option<Res<Session>>,
    scenario: Option<Res<CurrentScenario>>,
    reward: Res<RewardConfig>,
    layout: Res<ObservationLayout>,
    trainer: Option<Res<ActiveLearner>>,
    drivers: Res<ActionSources>,
    time: Res<Time<Real>>,
    probe: Option<Probe>,
    arenas: Query<(&Arena, &Pose, &Goal, &Clock, &SensorReadings)>,
    mut fields: ResMut<ScalarFields>,
) {
    let (Some(session), Some(scenario), Some(trainer), Some(probe)) = (session, scenario, trainer, probe)
    else {
        return;
    };
    let asked = view_state.0.overlays;
    let wanted = view_state.0.followed;
    let as_a_grid = view_state.0.grid && session.mode == SessionMode::Train;
    if as_a_grid || !(asked.potential || asked.value) {
        fields.potential = None;
        fields.value = None;
        fields.of = None;
        return;
    }
    let followed = arenas.iter().find(|(arena, ..)| arena.0 == wanted).or_else(|| arenas.iter().next());
    let Some((arena, pose, goal, clock, readings)) = followed else { return };
    let Some(scan_from) = probe.of(arena.0) else { return };
    let now_s = time.elapsed_secs_f64();
    let of = Of {
        potential: asked.potential,
        value: asked.value,
        scenario: scenario.0.clone(),
        mode: session.mode,
        arena: arena.0,
        goal: *goal,
        heading_rad: pose.heading_rad,
        clock: *clock,
        gradient_steps: trainer.0.gradient_steps(),
        opened_policy: session.opened_policy.as_ref().map(|(name, _)| name.clone()),
    };
    let before = fields.of.as_ref();
    let known = before.is_some_and(|before| *before == of);
    let more = before.is_none_or(|before| of.potential && !before.potential || of.value && !before.value);
    if known || (!more && now_s - fields.computed_at_s < EVERY_S) {
        return;
    }
    fields.of = Some(of);
    fields.computed_at_s = now_s;
    fields.version += 1;
    let version = fields.version;
    let scenario = &*scenario.0;
    let grid = FieldGrid::over(scenario);
    // One scan a point serves both.
    let mut scan = Scan::default();
    let mut observations = Vec::new();
    let mut potentials = Vec::new();
    let width = layout.width(scenario.lidar.beams);
    for Vec2 { x: x_m, y: y_m } in grid.points_m() {
        let there = Pose { x_m, y_m, heading_rad: pose.heading_rad };
        scan_from(&there, &mut scan);
        // From beyond a wall, or within one, the beams may see far.
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
        // The hand has no network: what the policy that it drives against would expect is shown in its place.
        let policies = drivers.arenas.iter().skip(arena.0).chain(&drivers.arenas);
        let network = match session.mode {
            SessionMode::Train => Some(trainer.0.network()),
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

/// Whether a point is within the enclosure and not within an inner wall.
fn is_floor(scenario: &Scenario, point_m: Vec2) -> bool {
    enclosure_distance(&scenario.enclosure, point_m) > 0.0
        && scenario.walls.iter().all(|wall| inner_wall_distance(wall, point_m) > 0.0)
}

/// The network that a driver asks, if it does.
fn network(driver: &ActionSource) -> Option<&QNetwork> {
    match driver {
        ActionSource::Policy(network) => Some(network),
        ActionSource::Manual(_) => None,
    }
}

/// max Q(s, .) of each of `n` observations: the value of acting greedily from there.
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
    fn the_grid_lies_over_the_box_around_an_l_and_its_notch_is_no_floor() {
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
        for (point, floor) in
            [(vec2(2.0, 1.5), true), (vec2(4.0, 1.5), false), (vec2(1.5, 0.52), false), (vec2(1.5, 0.6), true)]
        {
            assert_eq!(is_floor(&scenario, point), floor, "{point:?}");
        }
    }
}
