//! Sensors and reward terms that a plugin adds to the task.
//!
//! A plugin calls [`SimulationAppExt::add_sensor`] or [`SimulationAppExt::add_reward_term`] in its `build`. Pass the plugin
//! to a simulation in [`Extensions`](crate::simulation::Extensions). The readings of a sensor are a named slice of the
//! observation. A reward term is added to the reward and logged under its name, like the paper's own terms.

use bevy::ecs::schedule::{IntoScheduleConfigs, ScheduleConfigs};
use bevy::ecs::system::ScheduleSystem;
use bevy::prelude::*;

use super::fault::detect_faults;
use super::{Arena, Episode, ObservationLayout, SensorSlice, StepOutcomes};
use crate::control_step::{ControlStep, Reset, ResetSet, RewardSet, SenseSet};
use crate::scenario::column_name;

/// The names of the terms of the paper's reward, which are logged in the same way.
const BUILT_IN_TERMS: [&str; 4] = ["goal", "collision", "attraction", "repulsion"];

/// The handle of a reward term that a plugin has added.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RewardTerm(usize);

/// The reward terms of plugins: their names, and their values in this step.
#[derive(Resource, Clone, Debug, Default)]
pub struct ExtraRewards {
    names: Vec<String>,
    /// The values in this step: arenas x terms.
    values: Vec<f32>,
}

impl ExtraRewards {
    /// The names of the terms, in the order of addition.
    #[must_use]
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Sets the value of `term` in `arena` in this step. Without a call, it is 0.
    ///
    /// # Panics
    /// If the arena does not exist.
    pub fn set(&mut self, arena: usize, term: RewardTerm, reward: f32) {
        self.values[arena * self.names.len() + term.0] = reward;
    }

    /// The values of all terms in `arena` in this step, in the order of [`names`](Self::names). [`RewardSet::Sum`] resets them
    /// to 0.
    ///
    /// # Panics
    /// If the arena does not exist.
    #[must_use]
    pub fn of_arena(&self, arena: usize) -> &[f32] {
        &self.values[arena * self.names.len()..(arena + 1) * self.names.len()]
    }

    fn add(&mut self, name: &str) -> RewardTerm {
        assert!(
            !BUILT_IN_TERMS.contains(&name),
            "a plugin adds a reward term named `{name}`, which is the name of a built-in term; rename it"
        );
        if let Some(other) = self.names.iter().find(|other| column_name(other) == column_name(name)) {
            panic!(
                "the reward terms `{other}` and `{name}` have the same column in episodes.csv; rename one of them"
            );
        }
        self.names.push(name.into());
        RewardTerm(self.names.len() - 1)
    }

    /// Allocates the values for `arenas` arenas.
    pub(crate) fn resize(&mut self, arenas: usize) {
        self.values = vec![0.0; arenas * self.names.len()];
    }
}

/// Methods that add sensors and reward terms to a simulation's app.
pub trait SimulationAppExt {
    /// Adds a sensor named `name` with `width` values in every observation.
    ///
    /// `sensor` receives the handle of the sensor's slice and returns a system. The system runs in every control step and
    /// after every reset, and writes the slice of every arena's [`SensorReadings`](super::SensorReadings). It may read
    /// anything. It must draw random numbers from named streams only ([`random::stream`](crate::random::stream)).
    ///
    /// # Panics
    /// If another sensor has the same name, or the app is not a simulation.
    fn add_sensor<M, S>(&mut self, name: &str, width: usize, sensor: impl Fn(SensorSlice) -> S) -> &mut Self
    where
        S: IntoScheduleConfigs<ScheduleSystem, M>;

    /// Adds a reward term, logged as `reward_<name>`.
    ///
    /// `term` receives the handle of the term and returns a system. The system runs in every control step and sets the
    /// term's value in [`ExtraRewards`] for each arena; the value is added to the arena's reward.
    ///
    /// # Panics
    /// If another term has the same name (the paper's terms are goal, collision, attraction and repulsion) or the same column in
    /// `episodes.csv`, where characters other than letters and digits become underscores; or if the app is not a simulation.
    fn add_reward_term<M, S>(&mut self, name: &str, term: impl Fn(RewardTerm) -> S) -> &mut Self
    where
        S: IntoScheduleConfigs<ScheduleSystem, M>;
}

impl SimulationAppExt for App {
    fn add_sensor<M, S>(&mut self, name: &str, width: usize, sensor: impl Fn(SensorSlice) -> S) -> &mut Self
    where
        S: IntoScheduleConfigs<ScheduleSystem, M>,
    {
        let slice = self.world_mut().resource_mut::<ObservationLayout>().reserve(name, width);
        // Sensors write disjoint slices of one component, so their order does not matter.
        let system = || -> ScheduleConfigs<ScheduleSystem> { sensor(slice.clone()).into_configs() };
        self.add_systems(ControlStep, system().in_set(SenseSet::Sensors).ambiguous_with(SenseSet::Sensors))
            .add_systems(Reset, system().in_set(ResetSet::Sensors).ambiguous_with(ResetSet::Sensors))
    }

    fn add_reward_term<M, S>(&mut self, name: &str, term: impl Fn(RewardTerm) -> S) -> &mut Self
    where
        S: IntoScheduleConfigs<ScheduleSystem, M>,
    {
        let handle = self.world_mut().resource_mut::<ExtraRewards>().add(name);
        if handle == RewardTerm(0) {
            // Added with the first term, so that a step without reward plugins does not pay for the sum.
            self.add_systems(ControlStep, add_extra_rewards.in_set(RewardSet::Sum).before(detect_faults));
        }
        let system = term(handle).into_configs();
        self.add_systems(ControlStep, system.in_set(RewardSet::Terms).ambiguous_with(RewardSet::Terms))
    }
}

/// `Reward`: adds the plugins' terms to the outcomes and to the episodes' sums, then resets the terms to 0.
fn add_extra_rewards(
    mut extra: ResMut<ExtraRewards>,
    mut outcomes: ResMut<StepOutcomes>,
    mut arenas: Query<(&Arena, &mut Episode)>,
) {
    for (arena, mut episode) in &mut arenas {
        let outcome = &mut outcomes.0[arena.0];
        if outcome.inactive {
            continue;
        }
        let rewards = extra.of_arena(arena.0);
        outcome.extra_reward = rewards.iter().sum();
        episode.extra_rewards.resize(rewards.len(), 0.0);
        for (sum, reward) in episode.extra_rewards.iter_mut().zip(rewards) {
            *sum += reward;
        }
    }
    extra.values.fill(0.0);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[should_panic(expected = "the name of a built-in term")]
    fn a_term_of_a_plugin_cannot_have_the_name_of_a_built_in_one() {
        ExtraRewards::default().add("attraction");
    }

    #[test]
    #[should_panic(expected = "the reward terms `near-wall` and `near_wall` have the same column")]
    fn two_terms_of_plugins_cannot_have_the_same_column() {
        let mut extra = ExtraRewards::default();
        extra.add("near-wall");
        extra.add("near_wall");
    }
}
