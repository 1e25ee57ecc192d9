//! Traces: everything that the robot sensed and did in an episode, step by step.

use std::io::{self, Write};

use bevy::prelude::*;
use serde::Serialize;

use super::path::Clearance;
use super::{EpisodeResult, Evaluated, Evaluator};
use crate::agent::{ActionSelection, ActionSource, ActionSources, Decisions};
use crate::run::RunError;
use crate::task::{
    Actions, Arena, ArenaLayout, Clock, EpisodeEnd, EpisodeSetup, Goal, Pedestrians, Pose, Scan,
    SensorReadings, StepOutcome, StepOutcomes, Twist,
};

/// The state of an episode before one of its control steps, and what happened in that step. After the last state of an
/// episode there is no step.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TraceStep {
    /// Number of the episode, from 1.
    pub episode: usize,
    /// Control steps since the episode's start.
    pub step: u32,
    /// The robot's pose: `x_m`, `y_m`, `heading_rad`.
    #[serde(flatten)]
    pub pose: Pose,
    /// The robot's speed and turning rate: `v_m_s`, `w_rad_s`.
    #[serde(flatten)]
    pub twist: Twist,
    /// Position of the goal along x, in m.
    pub goal_x_m: f32,
    /// Position of the goal along y, in m.
    pub goal_y_m: f32,
    /// Distance between the robot's body and the nearest wall or obstacle, in m; 0 if they touch.
    pub clearance_m: f32,
    /// The scan that the policy received, one range per beam, in m: with the sensor's noise, dropout and latency.
    pub ranges_m: Vec<f32>,
    /// The readings of plugins' sensors; empty without such plugins.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sensors: Vec<f32>,
    /// The Q-value of each action; `None` in the last state, and for a classical driver.
    pub q_values: Option<Vec<f32>>,
    /// The action, an index into the policy's or driver's own motions or, without any, the robot's; `None` in the last state.
    pub action: Option<usize>,
    /// The reward of the step, by the default [`RewardConfig`](crate::task::RewardConfig) and plugins' terms; `None` in the
    /// last state.
    pub reward: Option<f32>,
    /// The reason why the episode ended; only in the last state.
    #[serde(serialize_with = "serialize_end")]
    pub outcome: Option<EpisodeEnd>,
}

impl TraceStep {
    /// Writes this step as one line: a JSON object with an additional field `policy`, the policy's name.
    ///
    /// # Errors
    /// `writer` cannot be written to.
    pub fn write_line(&self, policy: &str, mut writer: impl Write) -> io::Result<()> {
        #[derive(Serialize)]
        struct Line<'a> {
            policy: &'a str,
            #[serde(flatten)]
            step: &'a TraceStep,
        }
        serde_json::to_writer(&mut writer, &Line { policy, step: self })?;
        writer.write_all(b"\n")
    }
}

fn serialize_end<S: serde::Serializer>(end: &Option<EpisodeEnd>, serializer: S) -> Result<S::Ok, S::Error> {
    end.map(super::outcome_name).serialize(serializer)
}

/// The components of an arena that a trace contains.
type Traced = (
    &'static Arena,
    (&'static ArenaLayout, &'static Pedestrians),
    &'static Pose,
    &'static Twist,
    &'static Scan,
    &'static SensorReadings,
    &'static Goal,
    &'static Clock,
);

impl Evaluator {
    /// Runs `count` episodes as [`Evaluator::run`] does, with the same results, but one after the other, and passes every step
    /// to `each`: first the steps of episode 1, then those of episode 2, and so on.
    ///
    /// # Errors
    /// As for [`Evaluator::run`], or an error of `each`, which ends the evaluation.
    pub fn run_traced<'a, E: From<RunError>>(
        &mut self,
        evaluated: impl Into<Evaluated<'a>>,
        seed: u64,
        count: usize,
        setup: EpisodeSetup,
        mut each: impl FnMut(TraceStep) -> Result<(), E>,
    ) -> Result<Vec<EpisodeResult>, E> {
        let mut run = self.start(evaluated, seed, count, setup)?;
        let mut arenas = self.world_mut().query::<Traced>();
        while run.episodes.len() < count {
            let index = run.episodes.len();
            self.begin(&mut run, 1);
            // The time limit ends the episode.
            for step in 0.. {
                let Some(before) = state(&mut arenas, self.world_mut(), index + 1, step) else { break };
                self.advance(&mut run)?;
                each(with_decision(before, self.world_mut()))?;
                if let Some(episode) = run.episodes.get(index) {
                    let last = state(&mut arenas, self.world_mut(), index + 1, step + 1);
                    last.map_or(Ok(()), |last| each(TraceStep { outcome: Some(episode.end), ..last }))?;
                    break;
                }
            }
        }
        Ok(run.episodes)
    }

    /// Runs only the first episode of [`Evaluator::run`]. Returns its result and the robot's poses after 0, 1, ...
    /// control steps.
    ///
    /// # Errors
    /// As for [`Evaluator::run`].
    pub fn trace<'a>(
        &mut self,
        evaluated: impl Into<Evaluated<'a>>,
        seed: u64,
        setup: EpisodeSetup,
    ) -> Result<(EpisodeResult, Vec<Pose>), RunError> {
        let mut poses = Vec::new();
        let episodes = self.run_traced::<RunError>(evaluated, seed, 1, setup, |step| {
            poses.push(step.pose);
            Ok(())
        })?;
        let first = episodes.first().copied();
        first.map(|episode| (episode, poses)).ok_or_else(|| RunError::Failed("no episode was run".into()))
    }
}

/// The state of arena 0, which is `step` control steps into episode `episode`; `None` if there is no arena.
fn state(arenas: &mut QueryState<Traced>, world: &World, episode: usize, step: u32) -> Option<TraceStep> {
    let (_, (layout, pedestrians), pose, twist, scan, readings, goal, clock) =
        arenas.iter(world).find(|(arena, ..)| arena.0 == 0)?;
    Some(TraceStep {
        episode,
        step,
        pose: *pose,
        twist: *twist,
        goal_x_m: goal.x_m,
        goal_y_m: goal.y_m,
        clearance_m: Clearance::new(layout.indexed(pedestrians), pose, *clock, scan).distance_m,
        ranges_m: scan.ranges_m.clone(),
        sensors: readings.as_slice().to_vec(),
        q_values: None,
        action: None,
        reward: None,
        outcome: None,
    })
}

/// `before` with what arena 0 did in the control step that has just been taken.
fn with_decision(before: TraceStep, world: &World) -> TraceStep {
    let (actions, q_values) = (&world.resource::<Actions>().0, &world.resource::<Decisions>().q_values);
    let row = q_values.chunks(q_values.len() / actions.len()).next();
    let row = row.filter(|row| row.iter().all(|q| !q.is_nan()));
    // A policy with a map keeps its own Q-values.
    let of_driver = || match (
        world.resource::<ActionSelection>(),
        world.get_resource::<ActionSources>()?.arenas.first()?,
    ) {
        (ActionSelection::PerArena, ActionSource::Driver(driver)) => driver.q_values(),
        _ => None,
    };
    TraceStep {
        q_values: row.or_else(of_driver).map(<[f32]>::to_vec),
        action: actions.first().copied(),
        reward: world.resource::<StepOutcomes>().0.first().map(StepOutcome::total_reward),
        ..before
    }
}
