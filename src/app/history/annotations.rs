//! Annotations: texts at a position on the x axis, such as "transfer to Scenario II".
//!
//! In: a text and its env steps. Out: annotations, whose number is bounded.

/// A text at a position on the x axis.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Annotation {
    /// Env steps at the first occurrence.
    pub env_steps: u64,
    /// The text, a few words.
    pub text: String,
    /// Env steps at the last occurrence, if the same text was repeated.
    pub last_env_steps: u64,
}

/// The maximum number of annotations.
const MAX_ANNOTATIONS: usize = 60;
/// A repetition within this fraction of the axis extends the last annotation.
const REPEAT_FRACTION: f64 = 0.05;

/// Adds an annotation, or extends the last one if it has the same text and is recent. If there are too many, the one that
/// follows another most closely is removed.
pub fn add(annotations: &mut Vec<Annotation>, env_steps: u64, text: String) {
    let env_steps = annotations.last().map_or(env_steps, |last| env_steps.max(last.last_env_steps));
    if let Some(last) = annotations.last_mut()
        && last.text == text
        && (env_steps - last.last_env_steps) as f64 <= REPEAT_FRACTION * env_steps as f64
    {
        last.last_env_steps = env_steps;
        return;
    }
    annotations.push(Annotation { env_steps, text, last_env_steps: env_steps });
    if annotations.len() > MAX_ANNOTATIONS {
        let gap = |index: &usize| annotations[*index].env_steps - annotations[*index - 1].env_steps;
        if let Some(closest) = (1..annotations.len()).min_by_key(gap) {
            annotations.remove(closest);
        }
    }
}
