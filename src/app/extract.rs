//! The look: the world and the session become a [`Scene`] and a [`AppSnapshot`], once a frame.
//!
//! In: the ECS and the session, read only, as the systems' own parameters say. Out: [`Snapshot`], which the screen draws.

use bevy::prelude::*;

use super::CurrentViewState;
use super::app_snapshot::{AppSnapshot, Choice};
use super::commands::SessionMode;
use super::scalar_fields::ScalarFields;
use super::scene::{ArenaScene, DriverLabel, Scene};
use super::session::Session;
use super::session::trails::{ArenaTrails, Trails};
use crate::agent::{ActiveLearner, Decisions};
use crate::run::preset::Budget;
use crate::run::shipped;
use crate::scenario::{Scenario, pose_at};
use crate::task::{
    Actions, Arena, ArenaLayout, Clock, CurrentScenario, Episode, Goal, Pose, Scan, wrap_angle,
};

/// What the screen draws next; nothing before the first frame.
#[derive(Resource, Default)]
pub struct Snapshot {
    /// What there is to see, and how the session stands.
    pub now: Option<(Scene, AppSnapshot)>,
    /// What is shipped, which doesn't change.
    shipped: Option<(Vec<Choice>, Vec<Choice>)>,
}

/// Of more arenas than these the first are shown: nobody could tell more apart.
const MAX_ARENAS_SHOWN: usize = 100;

/// What is seen of an arena.
type Seen = (
    &'static Arena,
    &'static ArenaLayout,
    &'static Pose,
    &'static Goal,
    &'static Clock,
    &'static Scan,
    &'static Episode,
);

/// Takes the scene and the status.
#[expect(clippy::too_many_arguments, reason = "a system's parameters are what it reads")]
pub(super) fn extract(
    session: Option<Res<Session>>,
    scenario: Option<Res<CurrentScenario>>,
    trainer: Option<Res<ActiveLearner>>,
    decisions: Res<Decisions>,
    actions: Res<Actions>,
    trails: Res<Trails>,
    fields: Res<ScalarFields>,
    view_state: Res<CurrentViewState>,
    arenas: Query<Seen>,
    mut shown: ResMut<Snapshot>,
) {
    let (Some(session), Some(scenario), Some(trainer)) = (session, scenario, trainer) else { return };
    let scenario = &scenario.0;
    let mut seen: Vec<_> = arenas.iter().collect();
    seen.sort_by_key(|(arena, ..)| arena.0);
    seen.truncate(MAX_ARENAS_SHOWN);
    let part = session.pacer.interpolation();
    let motions = scenario.robot.motions.len();
    let none = ArenaTrails::default();
    let arenas: Vec<ArenaScene> = seen
        .into_iter()
        .map(|(arena, room, pose, goal, clock, scan, episode)| {
            let k = arena.0;
            let ways = trails.0.get(k).unwrap_or(&none);
            let q_values = decisions.q_values.get(k * motions..(k + 1) * motions).unwrap_or_default();
            let in_full = view_state.0.followed == k || session.mode != SessionMode::Train;
            ArenaScene {
                scenario: room.scenario.clone(),
                pose: ways.previous_pose.map_or(*pose, |before| between(&before, pose, part)),
                goal: *goal,
                obstacles: obstacles(&room.scenario, *clock, part),
                ranges_m: scan.ranges_m.clone(),
                scan_pose: scan.sensor_pose,
                driver: driver(&session, k),
                action: actions.0.get(k).copied().unwrap_or(0),
                explored: decisions.explored.get(k).copied().unwrap_or(false),
                q_values: if q_values.iter().all(|q| q.is_finite()) { q_values.to_vec() } else { Vec::new() },
                path_m: ways.path_m.clone(),
                trails: if in_full && view_state.0.overlays.trails {
                    ways.finished.iter().cloned().collect()
                } else {
                    Vec::new()
                },
                collisions: ways.collisions,
                goals_reached: ways.goals_reached,
                inactive: episode.inactive,
            }
        })
        .collect();
    if arenas.is_empty() {
        return;
    }
    let scene = Scene {
        scenario: scenario.clone(),
        arenas,
        potential: fields.potential.clone(),
        value: fields.value.clone(),
    };
    let (scenarios, presets) = shown.shipped.get_or_insert_with(shipped_choices).clone();
    let status = status(&session, &trainer, scenarios, presets);
    shown.now = Some((scene, status));
}

fn driver(session: &Session, arena: usize) -> DriverLabel {
    let present = || DriverLabel::Policy("Present policy".into());
    match (session.mode, arena, &session.opened_policy) {
        (SessionMode::Train, ..) => DriverLabel::Learner,
        (SessionMode::Drive, 0, _) => DriverLabel::User,
        (SessionMode::Compare, 1, Some((name, _))) => DriverLabel::Policy(name.clone()),
        _ => present(),
    }
}

/// A pose on the way from one to another.
fn between(from: &Pose, to: &Pose, part: f32) -> Pose {
    Pose {
        x_m: from.x_m + (to.x_m - from.x_m) * part,
        y_m: from.y_m + (to.y_m - from.y_m) * part,
        heading_rad: wrap_angle(from.heading_rad + wrap_angle(to.heading_rad - from.heading_rad) * part),
    }
}

/// Where the obstacles are, a part of the last step on from the step before.
fn obstacles(scenario: &Scenario, clock: Clock, part: f32) -> Vec<(f32, f32, f32)> {
    let period_s = scenario.task.control_period_s;
    let at = |step: u64| scenario.obstacles.iter().map(move |obstacle| pose_at(obstacle, step, period_s));
    at(clock.0.saturating_sub(1))
        .zip(at(clock.0))
        .map(|(from, to)| {
            let mix = |a: f32, b: f32| a + (b - a) * part;
            (mix(from.0, to.0), mix(from.1, to.1), from.2 + wrap_angle(to.2 - from.2) * part)
        })
        .collect()
}

fn shipped_choices() -> (Vec<Choice>, Vec<Choice>) {
    let scenarios = shipped::scenarios()
        .map(|(name, scenario)| Choice { from: name.into(), title: scenario.name, about: scenario.about })
        .collect();
    let presets = shipped::presets()
        .map(|(name, preset)| Choice { from: name.into(), title: name.into(), about: preset.about })
        .collect();
    (scenarios, presets)
}

fn status(
    session: &Session,
    trainer: &ActiveLearner,
    scenarios: Vec<Choice>,
    presets: Vec<Choice>,
) -> AppSnapshot {
    let learner = &trainer.0;
    let (steps_per_s, env_steps_per_s, frames_per_s) = session.throughput.per_s();
    let period_s = f64::from(session.config.scenario.task.control_period_s);
    let scenario_modified = session.scenario_modified();
    let with_own = |mut shipped: Vec<Choice>, own: &[Choice]| {
        shipped.extend_from_slice(own);
        shipped
    };
    AppSnapshot {
        paused: session.pacer.paused,
        pace: session.pacer.pace,
        mode: session.mode,
        scenario_modified,
        is_paper_scenario_1: shipped::is_paper_scenario_1(&session.config.scenario),
        scenario_from: session.config.scenario_from.clone(),
        preset_from: session.config.preset_from.clone(),
        scenarios: with_own(scenarios, &session.user_scenarios),
        presets: with_own(presets, &session.user_presets),
        seed: session.config.seed,
        transfer_from: session.config.transfer.as_ref().map(|transfer| transfer.policy.clone()),
        episodes: learner.episodes(),
        env_steps: learner.env_steps(),
        gradient_steps: learner.gradient_steps(),
        budget_env_steps: match session.config.preset.budget {
            Budget::EnvSteps(steps) => Some(steps),
            Budget::Episodes(_) => None,
        },
        epsilon: learner.epsilon(),
        success_rate: session.trainer_state.last_success_rate,
        best_success_rate: session.trainer_state.best.as_ref().map(|best| best.success_rate),
        env_steps_per_s,
        real_time_factor: steps_per_s * period_s,
        simulated_s: session.journal.steps as f64 * period_s,
        frames_per_s,
        opened_policy: session.opened_policy.as_ref().map(|(name, _)| name.clone()),
        notices: session.notices(),
        restart_loses_training: session.would_lose_training(learner.env_steps()),
        expert: session.expert().map(|(name, _)| name),
        saved_scenario: session.saved_scenario.clone(),
        draft: session.draft.clone(),
        has_disk: cfg!(not(target_arch = "wasm32")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_across_the_back_goes_the_short_way() {
        let at = |heading_rad| Pose { heading_rad, ..Pose::default() };
        let half = between(&at(3.0), &at(-3.0), 0.5).heading_rad;
        assert!(half.abs() > 3.1, "from 172 to -172 degrees by 180, not by 0: {half}");
    }
}
