//! The notes on schedules that end long before or after the budget, on exploration, and on evaluations.

use super::RunLength;
use super::learning::LOW_LEARNING_RATE;
use crate::learning::{Exploration, LearningConfig, Sampling, Schedule};
use crate::run::preset::{Budget, Preset};
use crate::scenario::{Note, NoteLevel};

/// A run gets a note if it is this many times as long as its learning-rate schedule.
const LONG_RUN: u64 = 4;
/// A long run gets a note only if its learning rate ends below this fraction of its first value.
const SMALL_FRACTION: f32 = 0.2;

/// `value` with four significant digits.
fn rounded(value: f32) -> f32 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

pub(super) fn check(preset: &Preset, length: RunLength, notes: &mut Vec<Note>) {
    let mut add = |field: &str, message: String| notes.push(Note::new(NoteLevel::Note, field, message));
    for (field, schedule) in schedules(&preset.learning) {
        if let Some(message) = too_slow(&schedule, length) {
            add(field, message);
        }
    }
    if let Some(message) = too_fast(&preset.learning.learning_rate, length) {
        add("learning.learning_rate", message);
    }
    let starts = preset.learning.replay.learning_starts;
    if let Exploration::Linear { start, end, env_steps } = preset.learning.exploration
        && start > end
        && env_steps <= starts
    {
        let message = format!(
            "ends at env step {env_steps}, but learning starts at {starts}, so the robot drives by an untrained network; help: \
             end it later, or give a smaller `replay.learning_starts`"
        );
        add("learning.exploration", message);
    }
    if let Some(message) = exploration(&preset.learning.exploration, preset.budget) {
        add("learning.exploration", message);
    }
    let every = preset.evaluation.every_env_steps;
    if let Some(most) = length.most.filter(|most| every > *most) {
        let message = format!(
            "is {every}, but {}, so only the first and the last policy are evaluated; help: give a smaller number",
            length.text("at most", most)
        );
        add("evaluation.every_env_steps", message);
    }
}

/// The schedules over env steps, by field.
fn schedules(learning: &LearningConfig) -> Vec<(&'static str, Schedule)> {
    let mut found = vec![("learning.learning_rate", learning.learning_rate)];
    if let Sampling::Prioritized { beta, importance_weights: true, .. } = learning.replay.sampling {
        found.push(("learning.replay.sampling.beta", beta));
    }
    if let Exploration::Linear { start: from, end: to, env_steps } = learning.exploration {
        found.push(("learning.exploration", Schedule::Linear { from, to, env_steps }));
    }
    found
}

/// The first value of `schedule`, its last value, and the env step of the last value; `None` if it has no end.
fn ends(schedule: &Schedule) -> Option<(f32, f32, u64)> {
    match *schedule {
        Schedule::Constant(_) | Schedule::Step { .. } => None,
        Schedule::Linear { from, to, env_steps }
        | Schedule::Exponential { from, to, env_steps }
        | Schedule::Cosine { from, to, env_steps } => Some((from, to, env_steps)),
    }
}

/// The problem if the run ends long before `schedule` does.
fn too_slow(schedule: &Schedule, length: RunLength) -> Option<String> {
    let most = length.most?;
    let at_most = || length.text("at most", most);
    if let Schedule::Step { factor, every_env_steps, .. } = *schedule {
        return (every_env_steps > most && factor < 1.0).then(|| {
            format!(
                "takes its first step at env step {every_env_steps}, but {}; help: give a smaller `every_env_steps`, or a \
                 larger budget",
                at_most()
            )
        });
    }
    let (from, to, env_steps) = ends(schedule).filter(|(from, to, _)| from != to)?;
    (env_steps / 2 > most).then(|| {
        let end = rounded(schedule.at(most));
        format!(
            "ends at env step {env_steps}, but {}, after which it has only gone from {from} to {end} instead of {to}; help: \
             end it at {most}, or give a larger budget",
            at_most()
        )
    })
}

/// The problem if the learning rate is small for most of the run.
fn too_fast(learning_rate: &Schedule, length: RunLength) -> Option<String> {
    let least = length.least;
    let at_least = || length.text("at least", least);
    if let Schedule::Step { from, .. } = *learning_rate {
        let middle = least / 2;
        let half = learning_rate.at(middle);
        return (from >= LOW_LEARNING_RATE && half < LOW_LEARNING_RATE).then(|| {
            format!(
                "has fallen from {from} to {half:e} at env step {middle}, but {}, so nothing more is learned; help: give a \
                 `factor` nearer to 1, or a larger `every_env_steps`",
                at_least()
            )
        });
    }
    let (from, to, env_steps) = ends(learning_rate)?;
    (to < from * SMALL_FRACTION && least / LONG_RUN > env_steps).then(|| {
        format!(
            "ends at env step {env_steps}, but {}, most of it with a learning rate of {to}; help: end it at {least}, or give \
             a smaller budget",
            at_least()
        )
    })
}

/// The problem with the values of epsilon, if they are questionable.
fn exploration(exploration: &Exploration, budget: Budget) -> Option<String> {
    let (Exploration::PerEpisode { start, end, .. } | Exploration::Linear { start, end, .. }) = *exploration;
    if start <= 0.0 && end <= 0.0 {
        return Some(
            "has no random actions, without which goals may never be found; help: start near 1".into(),
        );
    }
    if end >= 1.0 {
        return Some(
            "has random actions only, so the robot never drives by its policy; help: end near 0.05".into(),
        );
    }
    let Exploration::PerEpisode { decay, .. } = *exploration else { return None };
    if decay >= 1.0 && start > end {
        return Some(format!(
            "never decays from {start}, because `decay` is 1; help: give a decay such as 0.99"
        ));
    }
    let Budget::Episodes(episodes) = budget else { return None };
    let last = exploration.epsilon(0, episodes, None);
    (last > (start + end) / 2.0).then(|| {
        format!(
            "still has an epsilon of {last:.2} when the budget of {episodes} episodes ends; help: give a smaller `decay`, or \
             a larger budget"
        )
    })
}
