//! The notes on the learner: whether gradient steps are taken and change anything, the learning rate, weight decay, the
//! discount, the target network.

use super::RunLength;
use crate::learning::{LearningConfig, Schedule, TargetUpdate};
use crate::scenario::{Note, NoteLevel};

/// At this learning rate and above, learning diverges.
const HIGH_LEARNING_RATE: f32 = 0.1;
/// A learning rate below this one changes no weight of the order of one.
pub(super) const LOW_LEARNING_RATE: f32 = 1e-8;
/// If weights decay by at least this fraction per gradient step, nothing learned lasts.
const STRONG_DECAY: f32 = 1e-3;

pub(super) fn check(learning: &LearningConfig, length: RunLength, notes: &mut Vec<Note>) {
    let mut add = |level, field: &str, message: String| {
        notes.push(Note::new(level, format!("learning.{field}"), message));
    };
    if let Some((field, problem)) = no_gradient_step(learning, length) {
        add(NoteLevel::Warning, field, problem);
    } else if let Some(problem) = target_never_updated(learning, length) {
        add(NoteLevel::Note, "target_update.every", problem);
    }
    let rate = largest(&learning.learning_rate);
    if rate < LOW_LEARNING_RATE {
        let value = if rate > 0.0 { format!("at most {rate:e}") } else { "0 throughout".into() };
        let problem =
            format!("is {value}, so nothing will be learned; help: give a higher one, such as 0.0005");
        add(NoteLevel::Warning, "learning_rate", problem);
    } else if rate >= HIGH_LEARNING_RATE {
        let problem =
            format!("is up to {rate}, at which learning diverges; help: give a lower one, such as 0.0005");
        add(NoteLevel::Warning, "learning_rate", problem);
    }
    let decay = rate * learning.weight_decay;
    if decay >= STRONG_DECAY {
        let half = (std::f32::consts::LN_2 / decay).ceil();
        let problem = format!(
            "is {}: at a learning rate of {rate}, weights lose half of their value in {half} gradient steps; help: give a \
             smaller one, such as 0.01",
            learning.weight_decay
        );
        add(NoteLevel::Note, "weight_decay", problem);
    }
    let gamma = learning.gamma;
    if gamma <= 0.0 {
        let problem =
            "is 0: only the next reward counts, not whether a goal is reached later; help: give 0.9 to 0.999";
        add(NoteLevel::Note, "gamma", problem.into());
    } else if gamma >= 1.0 {
        let problem =
            "is 1: returns have no bound, and Q-values may grow without end; help: give 0.9 to 0.999";
        add(NoteLevel::Note, "gamma", problem.into());
    }
    let (starts, capacity) = (learning.replay.learning_starts, learning.replay.capacity);
    if starts > capacity as u64 {
        let problem = format!(
            "is {starts}, but the replay buffer holds {capacity} transitions: the first ones are lost before learning \
             starts; help: give a smaller number, or a larger `replay.capacity`"
        );
        add(NoteLevel::Note, "replay.learning_starts", problem);
    }
}

/// If the run takes no gradient step: the field that prevents it, and the problem.
fn no_gradient_step(learning: &LearningConfig, length: RunLength) -> Option<(&'static str, String)> {
    let most = length.most?;
    let (batch, train_freq) = (learning.batch_size as u64, learning.train_freq);
    let first = first_update(learning);
    if most >= first {
        return None;
    }
    let (field, value) = match () {
        () if train_freq > most => ("train_freq", train_freq),
        () if batch > most.min(learning.replay.learning_starts) => ("batch_size", batch),
        () => ("replay.learning_starts", learning.replay.learning_starts),
    };
    let problem = format!(
        "is {value}, so nothing will be learned: the first gradient step comes after {first} env steps, and {}; help: give a \
         smaller number, or a larger budget",
        length.text("at most", most)
    );
    Some((field, problem))
}

/// The number of env steps before the first gradient step.
fn first_update(learning: &LearningConfig) -> u64 {
    let enough = learning.replay.learning_starts.max(learning.batch_size as u64);
    enough.checked_next_multiple_of(learning.train_freq).unwrap_or(u64::MAX)
}

/// The problem if the target network is never updated in the run.
fn target_never_updated(learning: &LearningConfig, length: RunLength) -> Option<String> {
    let TargetUpdate::Hard { every } = learning.target_update else { return None };
    let updates = length.most?.checked_sub(first_update(learning))? / learning.train_freq + 1;
    let most = updates.saturating_mul(u64::from(learning.gradient_steps));
    (every > most).then(|| {
        format!(
            "is {every}, but the budget has at most {most} gradient steps, so the target network stays as it was at the \
             start; help: give a smaller number, or a larger budget"
        )
    })
}

/// The largest value of a schedule.
fn largest(schedule: &Schedule) -> f32 {
    match *schedule {
        Schedule::Constant(value) => value,
        Schedule::Linear { from, to, .. }
        | Schedule::Exponential { from, to, .. }
        | Schedule::Cosine { from, to, .. } => from.max(to),
        Schedule::Step { from, .. } => from,
    }
}
