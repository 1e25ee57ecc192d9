//! Sets of scenarios in a simulation: the scenario of each episode.
//!
//! In: a [`ScenarioPool`], which is a plugin and a resource. Out: an [`ArenaScenario`] in each arena, and the drawn scenario in
//! its [`ArenaLayout`] when an episode begins. Without a pool, all episodes have the scenario that the arenas were spawned
//! with.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use bevy::prelude::*;
use serde::{Deserialize, Serialize};

use super::{Arena, ArenaLayout, Clock, Episode, Fault, LevelProgress, TaskFault};
use crate::random::{self, Stream};
use crate::scenario::{
    FIRST_EVALUATION_LEVEL, LevelError, LevelGenerator, Scenario, ScenarioSet, SetMember, SetSource,
    TaskRules,
};

/// The number of level seeds for evaluations, from [`FIRST_EVALUATION_LEVEL`] on.
const EVALUATION_LEVELS: usize = 1_000_000;
/// The maximum number of levels per generator that are kept in memory.
const MAX_KEPT_LEVELS: usize = 4_096;

/// A set of scenarios, from which each episode of each arena draws one. Add it as a plugin to a simulation.
#[derive(Resource, Clone, Debug)]
pub struct ScenarioPool(Arc<[PoolMember]>);

#[derive(Debug)]
struct PoolMember {
    name: String,
    share: f64,
    source: PoolSource,
}

#[derive(Debug)]
enum PoolSource {
    Scenario(Box<ArenaLayout>),
    /// A generator, its number of training levels, and a cache of levels by seed.
    Levels(Box<LevelGenerator>, u32, Mutex<HashMap<u64, ArenaLayout>>),
}

/// A scenario of a pool.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ScenarioChoice {
    /// The index of the pool's member.
    pub member: u32,
    /// The seed of the level, if the member is a generator.
    pub level: u64,
}

impl Plugin for ScenarioPool {
    fn build(&self, app: &mut App) {
        app.insert_resource(self.clone());
    }
}

impl ScenarioPool {
    /// The pool of the scenarios of `set`, which must have no [`diagnostics`](ScenarioSet::diagnostics).
    #[must_use]
    pub fn new(set: &ScenarioSet) -> Self {
        let source = |source: &SetSource| match source {
            SetSource::Scenario(scenario) => {
                PoolSource::Scenario(Box::new(ArenaLayout::as_written(&Arc::new(Scenario::clone(scenario)))))
            }
            SetSource::Levels { generator, levels } => {
                PoolSource::Levels(generator.clone(), *levels, Mutex::default())
            }
        };
        let member = |member: &SetMember| PoolMember {
            name: member.name.clone(),
            share: f64::from(member.share),
            source: source(&member.source),
        };
        Self(set.members.iter().map(member).collect())
    }

    /// The number of members.
    #[must_use]
    pub fn members(&self) -> usize {
        self.0.len()
    }

    /// The number of training levels of each member; 0 for a scenario.
    pub(crate) fn training_level_counts(&self) -> impl Iterator<Item = usize> {
        self.0.iter().map(|member| match member.source {
            PoolSource::Scenario(_) => 0,
            PoolSource::Levels(_, levels, _) => levels as usize,
        })
    }

    /// The name of a member.
    #[must_use]
    pub fn name(&self, member: usize) -> &str {
        self.0.get(member).map_or("?", |member| &member.name)
    }

    /// The name of the chosen member; for a level, with its seed.
    #[must_use]
    pub fn title(&self, choice: ScenarioChoice) -> String {
        let name = self.name(choice.member as usize);
        match self.0.get(choice.member as usize).map(|member| &member.source) {
            Some(PoolSource::Levels(..)) => format!("{name}, level {}", choice.level),
            _ => name.into(),
        }
    }

    /// The task rules of all scenarios of a member; the default rules if there is no such member.
    #[must_use]
    pub fn rules(&self, member: usize) -> TaskRules {
        match self.0.get(member).map(|member| &member.source) {
            Some(PoolSource::Scenario(layout)) => layout.written.task.clone(),
            Some(PoolSource::Levels(generator, ..)) => generator.task.clone(),
            None => TaskRules::default(),
        }
    }

    /// For each member, a scenario with its name, robot, LIDAR and task rules; everything else is the default.
    pub fn tasks(&self) -> impl Iterator<Item = Scenario> + '_ {
        self.0.iter().map(|member| {
            let (robot, lidar, task) = match &member.source {
                PoolSource::Scenario(layout) => {
                    (&layout.written.robot, &layout.written.lidar, &layout.written.task)
                }
                PoolSource::Levels(generator, ..) => (&generator.robot, &generator.lidar, &generator.task),
            };
            let (robot, lidar, task) = (robot.clone(), lidar.clone(), task.clone());
            Scenario { name: member.name.clone(), robot, lidar, task, ..Scenario::default() }
        })
    }

    /// The layout of a scenario as written, without generated obstacles; `None` if there is no such member. The same choice
    /// gives the same layout.
    ///
    /// # Errors
    /// The generator has no such level.
    pub fn layout(&self, choice: ScenarioChoice) -> Result<Option<ArenaLayout>, LevelError> {
        let Some(member) = self.0.get(choice.member as usize) else { return Ok(None) };
        let (generator, kept) = match &member.source {
            PoolSource::Scenario(layout) => return Ok(Some(ArenaLayout::clone(layout))),
            PoolSource::Levels(generator, _, kept) => (generator, kept),
        };
        let lock = || kept.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(level) = lock().get(&choice.level) {
            return Ok(Some(level.clone()));
        }
        let level = ArenaLayout::as_written(&Arc::new(generator.level(choice.level)?));
        let mut kept = lock();
        if kept.len() >= MAX_KEPT_LEVELS {
            kept.clear();
        }
        Ok(Some(kept.entry(choice.level).or_insert(level).clone()))
    }

    /// The members of episodes 0 to `count` - 1 of an evaluation. In every prefix of the list, the number of episodes of each
    /// member is proportional to its share, to within about one episode.
    #[must_use]
    pub fn in_fixed_shares(&self, count: usize) -> Vec<usize> {
        let total: f64 = self.0.iter().map(|member| member.share).sum();
        let mut taken = vec![0_u32; self.0.len()];
        let next = |episode: usize| {
            let deficit = |k: usize| self.0[k].share / total * (episode + 1) as f64 - f64::from(taken[k]);
            let chosen = (0..taken.len()).reduce(|best, k| if deficit(k) > deficit(best) { k } else { best });
            let member = chosen.unwrap_or(0);
            taken[member] += 1;
            member
        };
        (0..count).map(next).collect()
    }

    /// The scenarios of episodes 0 to `count` - 1 of the evaluation with `seed`: the members in fixed shares, with levels that
    /// are never used in training.
    #[must_use]
    pub fn evaluation(&self, seed: u64, count: usize) -> Vec<ScenarioChoice> {
        let choice = |(episode, member): (usize, usize)| {
            let mut stream = random::stream(seed, "navigation: level", episode as u64);
            let level = FIRST_EVALUATION_LEVEL + random::uniform_index(&mut stream, EVALUATION_LEVELS) as u64;
            ScenarioChoice { member: member as u32, level }
        };
        self.in_fixed_shares(count).into_iter().enumerate().map(choice).collect()
    }

    /// Draws a training scenario: a member by its share and, for a generator, a level by `progress`, or uniformly without it.
    fn draw(&self, progress: Option<&LevelProgress>, stream: &mut Stream) -> ScenarioChoice {
        let total: f64 = self.0.iter().map(|member| member.share).sum();
        let mut left = f64::from(random::uniform_01(stream)) * total;
        let is_reached = |member: &PoolMember| {
            left -= member.share;
            left < 0.0
        };
        let member = self.0.iter().position(is_reached).unwrap_or(self.0.len() - 1);
        let level = match (&self.0[member].source, progress) {
            (PoolSource::Scenario(_), _) => 0,
            (PoolSource::Levels(..), Some(progress)) => progress.draw(member, stream),
            (PoolSource::Levels(_, levels, _), None) => {
                random::uniform_index(stream, *levels as usize) as u64
            }
        };
        ScenarioChoice { member: member as u32, level }
    }
}

/// The scenario of the [`ScenarioPool`] that an arena's episode takes place in. Only arenas of a simulation with a pool have it.
#[derive(Component, Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ArenaScenario {
    /// The scenario.
    pub choice: ScenarioChoice,
    /// The stream that draws the scenarios; `None` if the caller sets them
    /// ([`assign_scenarios`](crate::sim::assign_scenarios)).
    pub stream: Option<Stream>,
}

impl ArenaScenario {
    /// The component of arena `index` in the run with `seed`, before the first draw.
    #[must_use]
    pub(crate) fn new(seed: u64, index: u64) -> Self {
        Self { choice: ScenarioChoice::default(), stream: Some(random::stream(seed, "scenario", index)) }
    }

    /// The scenario of an arena that trains with `pool`; `None` if such an arena cannot be in this state.
    #[must_use]
    pub(crate) fn scenario_in(&self, pool: &ScenarioPool) -> Option<Arc<Scenario>> {
        self.stream.as_ref().filter(|stream| random::is_valid(stream))?;
        let can_be_drawn = |member: &PoolMember| match &member.source {
            PoolSource::Scenario(_) => true,
            PoolSource::Levels(_, levels, _) => self.choice.level < u64::from(*levels),
        };
        pool.0.get(self.choice.member as usize).filter(|member| can_be_drawn(member))?;
        Some(pool.layout(self.choice).ok()??.written)
    }
}

/// `Draw`, first: draws the scenario of every new episode.
pub(super) fn draw_scenarios(
    pool: Option<Res<ScenarioPool>>,
    progress: Option<Res<LevelProgress>>,
    mut fault: ResMut<TaskFault>,
    mut arenas: Query<(&Arena, &Clock, &Episode, &mut ArenaScenario, &mut ArenaLayout)>,
) {
    let Some(pool) = pool else { return };
    for (arena, clock, episode, mut scenario, mut layout) in &mut arenas {
        if !episode.pending_reset.begins_episode() {
            continue;
        }
        if let Some(stream) = &mut scenario.stream {
            scenario.choice = pool.draw(progress.as_deref(), stream);
        }
        match pool.layout(scenario.choice) {
            Ok(Some(drawn)) => *layout = drawn,
            Ok(None) => {}
            Err(why) => {
                fault.0.get_or_insert(Fault::NoLevel { arena: arena.0, step: clock.0, why });
            }
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
            source: SetSource::Scenario(Box::default()),
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
        let drawn: Vec<usize> = (0..8_000).map(|_| pool.draw(None, &mut stream).member as usize).collect();
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
