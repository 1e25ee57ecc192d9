//! The plugins of a user, in a form that can be added to any number of simulations.

use std::fmt;
use std::sync::Arc;

use bevy::prelude::*;

use super::SimulationBuilder;
use crate::task::{ExtraRewards, ObservationLayout, ObservationSlice};

/// A user's plugins. They are added to every simulation that is built with them.
///
/// ```
/// use bevy::prelude::*;
/// use wayfield::simulation::Extensions;
/// use wayfield::task::{Arena, ExtraRewards, RewardTerm, SimulationAppExt};
///
/// /// A reward of 0.1 in every step.
/// #[derive(Clone)]
/// struct AliveBonus;
///
/// impl Plugin for AliveBonus {
///     fn build(&self, app: &mut App) {
///         app.add_reward_term("alive", |term: RewardTerm| {
///             move |mut rewards: ResMut<ExtraRewards>, arenas: Query<&Arena>| {
///                 arenas.iter().for_each(|arena| rewards.set(arena.0, term, 0.1));
///             }
///         });
///     }
/// }
///
/// let extensions = Extensions::default().plugin(AliveBonus);
/// let (_sensors, reward_terms) = extensions.describe();
/// assert_eq!(reward_terms, ["alive"]);
/// ```
#[derive(Clone, Default)]
pub struct Extensions(Vec<AddPlugin>);

/// Adds one plugin to an app.
type AddPlugin = Arc<dyn Fn(&mut App) + Send + Sync>;

impl Extensions {
    /// Adds `plugin`. Its `build` may call the methods of [`SimulationAppExt`](crate::task::SimulationAppExt).
    #[must_use]
    pub fn plugin(mut self, plugin: impl Plugin + Clone) -> Self {
        self.0.push(Arc::new(move |app| {
            app.add_plugins(plugin.clone());
        }));
        self
    }

    /// Whether there are no plugins.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Adds all plugins to `app`, which must have the `TaskPlugin` already.
    pub(super) fn build(&self, app: &mut App) {
        self.0.iter().for_each(|add| add(app));
    }

    /// The slices that the plugins' sensors add to the observation, and the names of the plugins' reward terms.
    #[must_use]
    pub fn describe(&self) -> (Vec<ObservationSlice>, Vec<String>) {
        if self.is_empty() {
            return (Vec::new(), Vec::new());
        }
        let mut app = App::new();
        SimulationBuilder::new(&Arc::default()).extensions(self).add_to(&mut app);
        let world = app.world();
        (
            world.resource::<ObservationLayout>().slices().to_vec(),
            world.resource::<ExtraRewards>().names().to_vec(),
        )
    }
}

impl PartialEq for Extensions {
    /// Whether both are clones of the same plugins, by identity.
    fn eq(&self, other: &Self) -> bool {
        self.0.len() == other.0.len() && self.0.iter().zip(&other.0).all(|(one, two)| Arc::ptr_eq(one, two))
    }
}

impl fmt::Debug for Extensions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Extensions({})", self.0.len())
    }
}
