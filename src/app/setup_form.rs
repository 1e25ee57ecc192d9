//! The setup form: choices on the setup panel for the next training run.
//!
//! In: the session state. Out: the commands of the panel's buttons.

use super::app_status::AppStatus;
use super::commands::{Command, PolicySource};
use crate::run::folder::PAPER_TRANSFER_EPSILON;

/// The choices on the setup panel.
#[derive(Clone, Debug, PartialEq)]
pub struct SetupForm {
    /// The scenario: a file or a shipped name.
    pub scenario: String,
    /// The preset: a file or a shipped name.
    pub preset: String,
    /// The seed of a new run.
    pub seed: u64,
    /// Why the last seed entered was rejected, if it was.
    pub seed_problem: Option<String>,
    /// The policy of a transfer: the current or the best one.
    pub transfer_from: PolicySource,
    /// Epsilon at the start of a transfer, 0 to 1.
    pub epsilon: f32,
    /// The command that waits for the user to confirm that the current run may be discarded.
    pub awaiting_confirmation: Option<Command>,
    /// Scenario, preset and seed of the current run when the form was filled in.
    running: (String, String, u64),
}

impl SetupForm {
    /// The choices `kept` from the last frame, or those of the current run if `kept` was made for another run.
    #[must_use]
    pub fn keep_or_reset(kept: Option<Self>, status: &AppStatus) -> Self {
        let running = (status.scenario_from.clone(), status.preset_from.clone(), status.seed);
        kept.filter(|form| form.running == running).unwrap_or_else(|| {
            let (scenario, preset, seed) = running.clone();
            Self {
                scenario,
                preset,
                seed,
                seed_problem: None,
                transfer_from: PolicySource::Current,
                epsilon: PAPER_TRANSFER_EPSILON,
                awaiting_confirmation: None,
                running,
            }
        })
    }

    /// Whether the choices differ from the current run.
    pub fn differs_from_running(&self) -> bool {
        let (scenario, preset, seed) = &self.running;
        (scenario, preset, seed) != (&self.scenario, &self.preset, &self.seed)
    }

    /// The command that starts a run with these choices.
    #[must_use]
    pub fn start_training(&self) -> Command {
        let (scenario, preset) = (self.scenario.clone(), self.preset.clone());
        Command::StartTraining { scenario, preset, seed: self.seed }
    }

    /// The command that starts a run with these choices from the weights of `policy`.
    #[must_use]
    pub fn transfer(&self, policy: PolicySource) -> Command {
        let (scenario, preset) = (self.scenario.clone(), self.preset.clone());
        Command::Transfer { policy, scenario, preset, seed: self.seed, epsilon: self.epsilon }
    }

    /// Resets the choices to those of the current run.
    pub fn reset(&mut self, status: &AppStatus) {
        *self = Self::keep_or_reset(None, status);
    }

    /// Drops the pending confirmation if `is_obsolete` returns true for its command.
    pub fn cancel_confirmation(&mut self, is_obsolete: impl Fn(&Command) -> bool) {
        self.awaiting_confirmation.take_if(|command| is_obsolete(command));
    }
}
