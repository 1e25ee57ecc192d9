//! Sets of scenarios in a simulation: the scenario of each episode.
//!
//! In: a [`ScenarioPool`], which is a plugin and a resource. Out: an [`ArenaScenario`] in each arena, and the drawn scenario in
//! its [`ArenaLayout`] when an episode begins. Without a pool, all episodes have the scenario that the arenas were spawned
//! with.

use std::sync::Arc;

use bevy::prelude::*;
use serde::{Deserialize, Serialize};

use super::{ArenaLayout, Episode};
use crate::random::{self, Stream};
use crate::scenario::{Scenario, ScenarioSet, SetMember};

/// A set of scenarios, from which each episode of each arena draws one. Add it as a plugin to a simulation.
#[derive(Resource, Clone, Debug)]
pub struct ScenarioPool(Arc<[PoolMember]>);

/// A member of a pool.
#[derive(Debug)]
struct PoolMember {
    name: String,
    share: f64,
    scenario: Arc<Scenario>,
}

impl Plugin for ScenarioPool {
    fn build(&self, app: &mut App) {
        app.insert_resource(self.clone());
    }
}

impl ScenarioPool {
    /// The scenarios of `set`, which has no diagnostics.
    #[must_use]
    pub fn new(set: &ScenarioSet) -> Self {
        let member = |member: &SetMember| PoolMember {
            name: member.name.clone(),
            share: f64::from(member.share),
            scenario: Arc::new(member.scenario.clone()),
        };
        Self(set.members.iter().map(member).collect())
    }

    /// The number of members.
    #[must_use]
    pub fn members(&self) -> usize {
        self.0.len()
    }

    /// The name of a member.
    #[must_use]
    pub fn name(&self, member: usize) -> &str {
        self.0.get(member).map_or("?", |member| &member.name)
    }

    /// The scenario of a member; `None` if there is no such member.
    #[must_use]
    pub fn scenario(&self, member: usize) -> Option<&Arc<Scenario>> {
        Some(&self.0.get(member)?.scenario)
    }

    /// The members of episodes 0 to `count` - 1 of an evaluation. Every beginning of the list has each member as often as its
    /// share demands, to within one episode per other member.
    #[must_use]
    pub fn in_fixed_shares(&self, count: usize) -> Vec<usize> {
        let total: f64 = self.0.iter().map(|member| member.share).sum();
        let mut taken = vec![0_u32; self.0.len()];
        let next = |episode: usize| {
            let owed = |k: usize| self.0[k].share / total * (episode + 1) as f64 - f64::from(taken[k]);
            let most = (0..taken.len()).reduce(|best, k| if owed(k) > owed(best) { k } else { best });
            let member = most.unwrap_or(0);
            taken[member] += 1;
            member
        };
        (0..count).map(next).collect()
    }

    /// A random member, by the shares.
    fn draw(&self, stream: &mut Stream) -> usize {
        let total: f64 = self.0.iter().map(|member| member.share).sum();
        let mut left = f64::from(random::uniform_01(stream)) * total;
        let reached = |member: &PoolMember| {
            left -= member.share;
            left < 0.0
        };
        self.0.iter().position(reached).unwrap_or(self.0.len() - 1)
    }
}

/// The member of the [`ScenarioPool`] that an arena's episode takes place in. Only arenas of a simulation with a pool have it.
#[derive(Component, Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ArenaScenario {
    /// The number of the member.
    pub member: u32,
    /// The stream that draws the members; `None` if the caller sets them ([`assign_scenarios`](crate::sim::assign_scenarios)).
    pub stream: Option<Stream>,
}

impl ArenaScenario {
    /// The scenarios of arena `index` in the run with `seed`.
    #[must_use]
    pub(crate) fn new(seed: u64, index: u64) -> Self {
        Self { member: 0, stream: Some(random::stream(seed, "scenario", index)) }
    }

    /// The scenario of an arena in a training with `pool`; `None` if no such arena can have this state.
    #[must_use]
    pub(crate) fn scenario_in<'a>(&self, pool: &'a ScenarioPool) -> Option<&'a Scenario> {
        self.stream.as_ref().filter(|stream| random::is_valid(stream))?;
        pool.scenario(self.member as usize).map(|scenario| &**scenario)
    }
}

/// `Draw`, first: the scenario of every new episode.
pub(super) fn draw_scenarios(
    pool: Option<Res<ScenarioPool>>,
    mut arenas: Query<(&Episode, &mut ArenaScenario, &mut ArenaLayout)>,
) {
    let Some(pool) = pool else { return };
    for (episode, mut arena, mut layout) in &mut arenas {
        if !episode.pending_reset.begins_episode() {
            continue;
        }
        if let Some(stream) = &mut arena.stream {
            arena.member = pool.draw(stream) as u32;
        }
        if let Some(scenario) = pool.scenario(arena.member as usize) {
            *layout = ArenaLayout::undrawn(scenario);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pool(shares: &[f32]) -> ScenarioPool {
        let member = |(k, &share): (usize, &f32)| SetMember {
            name: k.to_string(),
            share,
            scenario: Scenario::default(),
        };
        let members = shares.iter().enumerate().map(member).collect();
        ScenarioPool::new(&ScenarioSet { name: "set".into(), members })
    }

    fn count(members: &[usize], member: usize) -> usize {
        members.iter().filter(|&&other| other == member).count()
    }

    #[test]
    fn members_are_drawn_by_their_shares() {
        let (pool, mut stream) = (pool(&[2.0, 1.0, 0.001, 1.0]), random::stream(5, "scenario", 0));
        let drawn: Vec<usize> = (0..8_000).map(|_| pool.draw(&mut stream)).collect();
        for (member, expected) in [(0, 4_000_usize), (1, 2_000), (3, 2_000)] {
            // Four standard deviations of a binomial distribution are below 180.
            assert!(
                count(&drawn, member).abs_diff(expected) < 180,
                "member {member}: {}",
                count(&drawn, member)
            );
        }
        assert!(count(&drawn, 2) < 20);
    }

    #[test]
    fn fixed_shares_are_kept_to_within_an_episode_from_the_first_episode_on() {
        let members = pool(&[2.0, 1.0, 1.0]).in_fixed_shares(40);
        assert_eq!([0, 1, 2].map(|member| count(&members, member)), [20, 10, 10]);
        for episodes in 1..40 {
            let half = count(&members[..episodes], 0);
            assert!(half.abs_diff(episodes - half) <= 2, "{half} of {episodes}");
        }
        assert_eq!(members[..3], [0, 1, 2]);
    }
}
