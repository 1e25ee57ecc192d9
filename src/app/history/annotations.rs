//! Marks: what happened beside the rows, at a place on the x axis ("transfer to Scenario II").
//!
//! In: words, and the env steps at which they apply. Out: few marks, however often something happens.

/// Something that happened.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Annotation {
    /// Env steps when it happened first.
    pub env_steps: u64,
    /// What, in a few words.
    pub text: String,
    /// Env steps when it happened last, if the same happened again and again.
    pub last_env_steps: u64,
}

/// At most so many are kept.
const MAX_ANNOTATIONS: usize = 60;
/// The same again within this share of the axis is no new mark.
const REGION: f64 = 0.05;

/// Adds a mark in order. The same as the last one, soon after it, only lengthens that; and when there are too many,
/// the one closest behind another goes.
pub fn add(marks: &mut Vec<Annotation>, env_steps: u64, text: String) {
    let env_steps = marks.last().map_or(env_steps, |last| env_steps.max(last.last_env_steps));
    if let Some(last) = marks.last_mut()
        && last.text == text
        && (env_steps - last.last_env_steps) as f64 <= REGION * env_steps as f64
    {
        last.last_env_steps = env_steps;
        return;
    }
    marks.push(Annotation { env_steps, text, last_env_steps: env_steps });
    if marks.len() > MAX_ANNOTATIONS {
        let gap = |index: &usize| marks[*index].env_steps - marks[*index - 1].env_steps;
        if let Some(closest) = (1..marks.len()).min_by_key(gap) {
            marks.remove(closest);
        }
    }
}
