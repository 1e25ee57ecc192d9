//! What is chosen on the setup panel but not yet begun.
//!
//! In: the status, whenever what runs becomes another. Out: what the buttons would begin.

use super::app_snapshot::AppSnapshot;
use super::commands::Command;

/// Epsilon at the start of a transfer, as the paper has it.
const EPSILON: f32 = 0.5;

/// What is chosen on the setup panel; it lives as long as the window.
#[derive(Clone, Debug, PartialEq)]
pub struct SetupForm {
    /// The world, as it would be asked for.
    pub scenario: String,
    /// The learner, as it would be asked for.
    pub preset: String,
    /// The seed of a new training.
    pub seed: u64,
    /// Epsilon at the start of a transfer.
    pub epsilon: f32,
    /// What was asked for, while the user is asked back whether the present training may be given up for it.
    pub awaiting_confirmation: Option<Command>,
    running: (String, String, u64),
}

impl SetupForm {
    /// The choices `kept` from the last frame, or those that run if another training runs since.
    #[must_use]
    pub fn resume(kept: Option<Self>, status: &AppSnapshot) -> Self {
        let running = (status.scenario_from.clone(), status.preset_from.clone(), status.seed);
        kept.filter(|form| form.running == running).unwrap_or_else(|| {
            let (scenario, preset, seed) = running.clone();
            Self { scenario, preset, seed, epsilon: EPSILON, awaiting_confirmation: None, running }
        })
    }

    /// Whether it is another training than the one that runs.
    pub fn differs_from_running(&self) -> bool {
        let (scenario, preset, seed) = &self.running;
        (scenario, preset, seed) != (&self.scenario, &self.preset, &self.seed)
    }
}
