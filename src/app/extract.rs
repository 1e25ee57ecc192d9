//! Extraction: the world and the session become a [`Scene`] and an [`AppStatus`], once per frame.
//!
//! In: the ECS and the session, read-only. Out: [`Snapshot`], which the screen draws.

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;

use super::CurrentViewState;
use super::app_status::{AppStatus, BestSoFar, Choice, ExpertChoice};
use super::commands::SessionMode;
use super::editor_backup::EditorBackup;
use super::scalar_fields::ScalarFields;
use super::scene::{ArenaScene, Scene};
use super::session::trails::ArenaTrails;
use super::session::{
    ActiveMode, Autosave, Evaluations, Journal, Notices, OpenedFiles, Pacer, QuitQuestion, ScenarioSource,
    Throughput, Trails, TrainingRun, comparison,
};
use crate::agent::{ActionSource, ActionSources, ActiveLearner, Decisions, DriverSource};
use crate::run::preset::Budget;
use crate::run::shipped;
use crate::scenario::IndexedScenario;
use crate::task::{
    Actions, ActiveActionSet, Arena, ArenaLayout, ArenaScenario, Clock, CurrentScenario, Episode, Goal,
    Pedestrians, Pose, Scan, ScenarioPool, wrap_angle,
};

/// The snapshot that the screen draws next.
#[derive(Resource, Default)]
pub struct Snapshot {
    /// The scene and the state of the session; `None` before the first frame.
    pub now: Option<(Scene, AppStatus)>,
    /// Shipped scenarios and presets, which never change.
    shipped: Option<(Vec<Choice>, Vec<Choice>)>,
}

/// Maximum number of arenas shown. In a larger grid they would be too small.
const MAX_ARENAS_SHOWN: usize = 100;

/// The components of an arena that are shown.
type ArenaComponents = (
    &'static Arena,
    &'static ArenaLayout,
    &'static Pose,
    &'static Goal,
    (&'static Clock, &'static Pedestrians),
    &'static Scan,
    &'static Episode,
    Option<&'static ArenaScenario>,
);

/// The resources of the session that are shown.
#[derive(SystemParam)]
pub(super) struct SessionView<'w> {
    run: Res<'w, TrainingRun>,
    mode: Res<'w, ActiveMode>,
    pacer: Res<'w, Pacer>,
    throughput: Res<'w, Throughput>,
    journal: Res<'w, Journal>,
    opened: Res<'w, OpenedFiles>,
    source: Res<'w, ScenarioSource>,
    notices: Res<'w, Notices>,
    autosave: Res<'w, Autosave>,
    backup: Res<'w, EditorBackup>,
    quit_question: Res<'w, QuitQuestion>,
    evaluations: Res<'w, Evaluations>,
    learner: Res<'w, ActiveLearner>,
}

/// The parts of the world that are shown.
#[derive(SystemParam)]
pub(super) struct WorldView<'w, 's> {
    scenario: Res<'w, CurrentScenario>,
    decisions: Res<'w, Decisions>,
    actions: Res<'w, Actions>,
    action_set: Res<'w, ActiveActionSet>,
    sources: Res<'w, ActionSources>,
    pool: Option<Res<'w, ScenarioPool>>,
    trails: Res<'w, Trails>,
    arenas: Query<'w, 's, ArenaComponents>,
}

/// Extracts the scene and the app's status.
pub(super) fn extract(
    session: SessionView,
    world: WorldView,
    fields: Res<ScalarFields>,
    view_state: Res<CurrentViewState>,
    mut snapshot: ResMut<Snapshot>,
) {
    let arenas = arena_scenes(&session, &world, &view_state);
    if arenas.is_empty() {
        return;
    }
    let scene = Scene {
        scenario: world.scenario.0.clone(),
        arenas,
        potential: fields.potential.clone(),
        value: fields.value.clone(),
    };
    let (scenarios, presets) = snapshot.shipped.get_or_insert_with(shipped_choices).clone();
    snapshot.now = Some((scene, app_status(&session, scenarios, presets)));
}

fn arena_scenes(session: &SessionView, world: &WorldView, view_state: &CurrentViewState) -> Vec<ArenaScene> {
    let mut shown: Vec<_> = world.arenas.iter().collect();
    shown.sort_by_key(|(arena, ..)| arena.0);
    shown.truncate(MAX_ARENAS_SHOWN);
    let part = session.pacer.interpolation();
    let mode = session.mode.mode();
    let actions = world.decisions.q_values.len() / world.actions.0.len().max(1);
    let no_trails = ArenaTrails::default();
    let arena_scenes =
        shown.into_iter().map(|(arena, layout, pose, goal, (clock, pedestrians), scan, episode, member)| {
            let k = arena.0;
            let trails = world.trails.0.get(k).unwrap_or(&no_trails);
            let driver_source =
                if mode == SessionMode::Compare { driver_source(world.sources.arenas.get(k)) } else { None };
            let robot = &layout.scenario.robot;
            let (motions, q_values) = match driver_source {
                Some(source) => (source.motions().unwrap_or(&robot.motions).to_vec(), source.q_values()),
                None => (
                    world.action_set.motions(robot),
                    world.decisions.q_values.get(k * actions..(k + 1) * actions),
                ),
            };
            let q_values = q_values.unwrap_or_default();
            let is_large = view_state.0.followed == k || mode != SessionMode::Train;
            ArenaScene {
                scenario: layout.scenario.clone(),
                written: layout.written.clone(),
                set_member: world.pool.as_ref().zip(member).map(|(pool, member)| pool.title(member.choice)),
                pose: trails.previous_pose.map_or(*pose, |before| interpolate(&before, pose, part)),
                goal: *goal,
                // The clock of an inactive arena stands still: with interpolation, its obstacles would repeat their last step
                // in every frame.
                obstacles: obstacles(
                    layout.indexed(pedestrians),
                    *clock,
                    if episode.inactive { 1.0 } else { part },
                ),
                ranges_m: scan.ranges_m.clone(),
                scan_pose: scan.sensor_pose,
                driver: session.mode.driver(k),
                motions,
                action: world.actions.0.get(k).copied().unwrap_or(0),
                explored: world.decisions.explored.get(k).copied().unwrap_or(false),
                q_values: if q_values.iter().all(|q| q.is_finite()) { q_values.to_vec() } else { Vec::new() },
                // Before its first step, an episode still has the driver of the previous one.
                plan: driver_source.filter(|_| episode.steps > 0).and_then(DriverSource::plan),
                path_m: trails.path_m.clone(),
                trails: if is_large && view_state.0.overlays.trails {
                    trails.finished.iter().cloned().collect()
                } else {
                    Vec::new()
                },
                score: trails.score,
                inactive: episode.inactive,
            }
        });
    arena_scenes.collect()
}

/// The driver source, if `source` is one.
fn driver_source(source: Option<&ActionSource>) -> Option<&DriverSource> {
    match source {
        Some(ActionSource::Driver(driver)) => Some(driver),
        _ => None,
    }
}

/// The pose at the fraction `part` of the way between two poses. The heading turns the short way.
fn interpolate(from: &Pose, to: &Pose, part: f32) -> Pose {
    Pose {
        x_m: from.x_m + (to.x_m - from.x_m) * part,
        y_m: from.y_m + (to.y_m - from.y_m) * part,
        heading_rad: wrap_angle(from.heading_rad + wrap_angle(to.heading_rad - from.heading_rad) * part),
    }
}

/// Poses of the obstacles (x in m, y in m, rotation in rad) at the fraction `part` of the last control step.
fn obstacles(layout: IndexedScenario, clock: Clock, part: f32) -> Vec<(f32, f32, f32)> {
    let period_s = layout.scenario.task.control_period_s;
    let pose = |index| {
        let to = layout.pose_at(index, clock.0);
        let from = match layout.pedestrian(index) {
            Some(pedestrian) => {
                let moved_m = pedestrian.velocity_m_s * period_s;
                (to.0 - moved_m.x, to.1 - moved_m.y, to.2)
            }
            None => layout.pose_at(index, clock.0.saturating_sub(1)),
        };
        let mix = |a: f32, b: f32| a + (b - a) * part;
        (mix(from.0, to.0), mix(from.1, to.1), from.2 + wrap_angle(to.2 - from.2) * part)
    };
    (0..layout.scenario.obstacles.len()).map(pose).collect()
}

fn shipped_choices() -> (Vec<Choice>, Vec<Choice>) {
    let scenarios = shipped::scenarios().map(|(name, scenario)| Choice {
        from: name.into(),
        title: scenario.name,
        about: scenario.about,
    });
    let levels = shipped::level_generators().map(|(name, levels)| Choice {
        from: name.into(),
        title: levels.name,
        about: levels.about,
    });
    let scenarios = scenarios.chain(levels).collect();
    let presets = shipped::presets()
        .map(|(name, preset)| Choice {
            from: name.into(),
            title: shipped::preset_title(name).unwrap_or(name).into(),
            about: preset.about,
        })
        .collect();
    (scenarios, presets)
}

fn app_status(session: &SessionView, scenarios: Vec<Choice>, presets: Vec<Choice>) -> AppStatus {
    let (config, trainer_state) = (&session.run.config, &session.run.trainer_state);
    let learner = &session.learner.0;
    let rates = session.throughput.rates();
    let period_s = f64::from(config.scenario.task.control_period_s);
    AppStatus {
        paused: session.pacer.is_paused(),
        pace: session.pacer.pace,
        mode: session.mode.mode(),
        scenario_modified: session.source.is_modified(config),
        is_paper_scenario_1: config.is_paper_scenario_1(),
        scenario_from: config.scenario_from.clone(),
        is_set: config.scenario_set.is_some(),
        needs: config.preset.fit(),
        preset_from: config.preset_from.clone(),
        scenarios: [scenarios, session.opened.scenarios.clone()].concat(),
        presets: [presets, session.opened.presets.clone()].concat(),
        seed: config.seed,
        transfer_from: config.transfer.as_ref().map(|transfer| transfer.policy.clone()),
        episodes: learner.episodes(),
        env_steps: learner.env_steps(),
        gradient_steps: learner.gradient_steps(),
        budget_env_steps: match config.preset.budget {
            Budget::EnvSteps(steps) => Some(steps),
            Budget::Episodes(_) => None,
        },
        epsilon: learner.epsilon(),
        success_rate: trainer_state.last_success_rate,
        best: session
            .evaluations
            .best(trainer_state)
            .map(|row| BestSoFar { success_rate: row.success_rate, env_steps: row.env_steps }),
        env_steps_per_s: rates.env_steps_per_s,
        real_time_factor: rates.control_steps_per_s * period_s,
        simulated_s: session.journal.steps as f64 * period_s,
        frames_per_s: rates.frames_per_s,
        opened_policy: session.opened.policy.as_ref().map(|(name, _)| name.clone()),
        opened_driver: session.opened.driver.as_ref().map(|(name, _)| name.clone()),
        notices: session.notices.list(),
        restart_loses_training: session.run.would_lose_training(learner.env_steps()),
        last_session: session.autosave.last_session(),
        unsaved_edits: session.backup.offer(),
        quit_question: session.quit_question.0,
        expert: comparison::expert(config).map(|expert| ExpertChoice {
            is_new_here: expert.trained_in != config.scenario_title(),
            name: comparison::expert_name(expert),
        }),
        tested: session.run.tested,
        saved_scenario: session.source.saved().cloned(),
        has_disk: cfg!(not(target_arch = "wasm32")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_heading_is_interpolated_the_short_way() {
        let at = |heading_rad| Pose { heading_rad, ..Pose::default() };
        let half = interpolate(&at(3.0), &at(-3.0), 0.5).heading_rad;
        assert!(half.abs() > 3.1, "from 172 to -172 degrees via 180, not via 0: {half}");
    }
}
