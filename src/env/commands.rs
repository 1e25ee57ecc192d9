//! What the caller commands the robots to do: actions by index, or motions.

use bevy::prelude::World;

use super::VecEnvError;
use crate::scenario::{Motion, Scenario};
use crate::task::{Actions, CommandedMotions};

/// The commands for one control step, one per environment.
#[derive(Clone, Copy, Debug)]
pub enum Commands<'a> {
    /// Indices into the robot's motions.
    Actions(&'a [usize]),
    /// Speeds and turning rates. They are limited to the range that the robot's motions and 0 span; then turning rates are
    /// limited to what the robot's minimum turning radius allows at that speed.
    Motions(&'a [Motion]),
}

/// The number of actions, and the limits of commanded motions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CommandRules {
    pub num_actions: usize,
    /// The smallest speed and turning rate.
    pub low: Motion,
    /// The largest speed and turning rate.
    pub high: Motion,
}

impl CommandRules {
    /// The rules for the robot of `scenario`.
    pub fn of(scenario: &Scenario) -> Self {
        let (low, high) = scenario.robot.motion_limits();
        Self { num_actions: scenario.robot.motions.len(), low, high }
    }

    /// Checks `commands` for the first `num_envs` environments of `world`, and sets them for the next control step.
    pub fn apply(
        &self,
        commands: Commands<'_>,
        num_envs: usize,
        world: &mut World,
    ) -> Result<(), VecEnvError> {
        match commands {
            Commands::Actions(actions) => {
                self.check_actions(actions, num_envs)?;
                world.resource_mut::<CommandedMotions>().0.clear();
                world.resource_mut::<Actions>().0[..num_envs].copy_from_slice(actions);
            }
            Commands::Motions(motions) => {
                check_motions(motions, num_envs)?;
                let limited = motions.iter().map(|motion| Motion {
                    v_m_s: motion.v_m_s.clamp(self.low.v_m_s, self.high.v_m_s),
                    w_rad_s: motion.w_rad_s.clamp(self.low.w_rad_s, self.high.w_rad_s),
                });
                let arenas = world.resource::<Actions>().0.len();
                let mut commanded = world.resource_mut::<CommandedMotions>();
                commanded.0.clear();
                commanded.0.extend(limited.map(Some));
                commanded.0.resize(arenas, Some(Motion { v_m_s: 0.0, w_rad_s: 0.0 }));
            }
        }
        Ok(())
    }

    fn check_actions(&self, actions: &[usize], num_envs: usize) -> Result<(), VecEnvError> {
        check_count(actions.len(), num_envs)?;
        let num_actions = self.num_actions;
        match actions.iter().enumerate().find(|(_, action)| **action >= num_actions) {
            Some((env, &action)) => Err(VecEnvError::Action { env, action, num_actions }),
            None => Ok(()),
        }
    }
}

/// Checks that there is one value per environment.
pub(super) fn check_count(given: usize, num_envs: usize) -> Result<(), VecEnvError> {
    if given == num_envs { Ok(()) } else { Err(VecEnvError::ActionCount { given, num_envs }) }
}

fn check_motions(motions: &[Motion], num_envs: usize) -> Result<(), VecEnvError> {
    check_count(motions.len(), num_envs)?;
    match motions.iter().position(|motion| !motion.v_m_s.is_finite() || !motion.w_rad_s.is_finite()) {
        Some(env) => Err(VecEnvError::Motion { env }),
        None => Ok(()),
    }
}
