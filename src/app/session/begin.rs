//! A training begun in the window: anew, from a policy's weights, or from a checkpoint.
//!
//! In: names or files. Out: a [`Session`] in place of the one before, and its arenas at their first observation. If
//! something cannot be used, all stays as it was.

use std::path::Path;
use std::sync::Arc;

use bevy::platform::cell::SyncCell;
use bevy::platform::time::Instant;
use bevy::prelude::*;

use super::advance::WARNING;
use super::journal::{self, Journal};
use super::modes::{self, Rounds};
use super::pacer::Pacer;
use super::trails::Trails;
#[cfg(not(target_arch = "wasm32"))]
use super::watch;
use super::worlds::as_it_stands;
use super::{Curves, First, Session, Speed};
use crate::app::orders::Mode;
use crate::app::status::Weight;
use crate::learning::{Learner, Policy};
use crate::run::checkpoint::{self, Loaded, Standing};
use crate::run::examiner::Examiner;
use crate::run::folder::{RunConfig, RunFolder, Transfer};
use crate::run::records::{EpisodeRow, EvaluationRow};
use crate::run::{RunError, follow, simulation, start};
use crate::scenario::Scenario;

/// A training that could begin.
struct Beginning {
    config: RunConfig,
    init: Option<Policy>,
    learner: Learner,
    standing: Standing,
}

/// The first session of the process. What was asked for was checked before; where it cannot be used all the same, the
/// default begins, with a notice.
pub(super) fn first(world: &mut World, first: &First) {
    let usual = First::default();
    let asked = from_nothing(&first.scenario, &first.preset, first.seed);
    let problem = asked.as_ref().err().map(ToString::to_string);
    let instead = |preset: &str| from_nothing(&usual.scenario, preset, first.seed);
    match asked.or_else(|_| instead(&first.preset)).or_else(|_| instead(&usual.preset)) {
        Ok(beginning) => {
            let mut session = session(world, beginning, Pacer::new(first.pace, first.paused));
            session.offer_own();
            world.insert_resource(session);
        }
        // What is compiled in can be used: a test sees to it.
        Err(error) => error!("{error}"),
    }
    world.try_resource_scope(|world, mut session: Mut<Session>| {
        for problem in first.not_understood.iter().cloned().chain(problem) {
            session.tell(Weight::Failed, problem);
        }
        if first.edit && session.config.scenario_from != first.scenario {
            // It cannot be driven in, as was told, but perhaps be mended.
            let _ = session.open_to_edit(Path::new(&first.scenario));
        }
        #[cfg(not(target_arch = "wasm32"))]
        session.wait_for(&first.scenario, watch::Then::Begin);
        if let Some(path) = &first.open {
            session.open_or_tell(world, path);
        }
    });
}

fn prepare(config: RunConfig, init: Option<Policy>) -> Result<Beginning, RunError> {
    let learner = start::learner(&config, init.as_ref())?;
    let standing =
        Standing { next_evaluation: config.preset.evaluation.every_env_steps, ..Standing::default() };
    Ok(Beginning { config, init, learner, standing })
}

fn from_nothing(scenario: &str, preset: &str, seed: u64) -> Result<Beginning, RunError> {
    prepare(RunConfig::resolve(scenario, preset, seed)?, None)
}

/// The session of `beginning`, whose arenas it puts in place of whatever there is.
fn session(world: &mut World, beginning: Beginning, pacer: Pacer) -> Session {
    let Beginning { config, init, learner, standing } = beginning;
    let scenario = Arc::new(config.scenario.clone());
    simulation::begin(world, &scenario, &config.preset, config.seed, learner);
    world.resource_mut::<Trails>().restart(config.preset.arenas);
    world.resource_mut::<Curves>().0.clear();
    Session {
        examiner: SyncCell::new(examiner(&config, &scenario)),
        journal: Journal::new(config.clone()),
        earlier_s: standing.wall_s,
        as_asked: as_it_stands(&config.scenario_from).unwrap_or_else(|| config.scenario.clone()),
        saved_world: None,
        draft: None,
        coming: None,
        #[cfg(not(target_arch = "wasm32"))]
        watches: watch::Watches::of(&config.scenario_from),
        scenario,
        config,
        standing,
        init,
        mode: Mode::Train,
        pacer,
        opened: None,
        notices: Vec::new(),
        own_scenarios: Vec::new(),
        own_presets: Vec::new(),
        speed: Speed::default(),
        evaluations: Vec::new(),
        examining: false,
        examiner_is_stale: false,
        aside: None,
        rounds: Rounds::default(),
        broken: false,
        saved_at: None,
        asked_once: None,
        overwrites: None,
        began: Instant::now(),
    }
}

/// Who examines the policies of a training in `scenario`.
pub(super) fn examiner(config: &RunConfig, scenario: &Arc<Scenario>) -> Examiner {
    let seed = follow::evaluation_seed(config.seed);
    Examiner::new(scenario, config.preset.evaluation.navigations, seed)
}

impl Session {
    /// Puts `beginning` in place of this training; what the user has opened and told stays.
    fn replace(&mut self, world: &mut World, beginning: Beginning) {
        let mut pacer = self.pacer.clone();
        pacer.pace = self.aside.as_ref().map_or(pacer.pace, modes::Aside::pace);
        let new = session(world, beginning, pacer);
        let old = std::mem::replace(self, new);
        self.opened = old.opened;
        self.notices = old.notices;
        self.untell(WARNING);
        self.own_scenarios = old.own_scenarios;
        self.own_presets = old.own_presets;
        self.speed = old.speed;
        self.saved_world = old.saved_world;
        self.draft = old.draft;
        self.offer_own();
    }

    /// A new training from nothing.
    ///
    /// # Errors
    /// The scenario or the preset cannot be used.
    pub(super) fn begin(
        &mut self,
        world: &mut World,
        scenario: &str,
        preset: &str,
        seed: u64,
    ) -> Result<(), RunError> {
        let beginning = from_nothing(scenario, preset, seed)?;
        self.pacer.paused = false;
        self.replace(world, beginning);
        Ok(())
    }

    /// A new training of the same preset and seed from nothing, in `scenario`, which is asked for by `from`.
    ///
    /// # Errors
    /// The preset does not fit.
    pub(super) fn begin_in(
        &mut self,
        world: &mut World,
        scenario: Scenario,
        from: String,
    ) -> Result<(), RunError> {
        let mut config = self.config.clone();
        config.scenario = scenario;
        config.scenario_from = from;
        config.transfer = None;
        let beginning = prepare(config, None)?;
        self.pacer.paused = false;
        self.replace(world, beginning);
        Ok(())
    }

    /// A new training of the same preset and seed from `policy`, which is called `name`; in another scenario, if there is
    /// one.
    ///
    /// # Errors
    /// The policy does not fit.
    pub(super) fn begin_from(
        &mut self,
        world: &mut World,
        scenario: Option<(&str, Scenario)>,
        (name, policy): (String, Policy),
        epsilon: f32,
    ) -> Result<(), RunError> {
        let mut config = self.config.clone();
        if let Some((from, scenario)) = scenario {
            config.scenario_from = from.into();
            config.scenario = scenario;
        }
        config.transfer = Some(Transfer { policy: name, epsilon: Some(epsilon.clamp(0.0, 1.0)) });
        let beginning = prepare(config, Some(policy))?;
        self.replace(world, beginning);
        Ok(())
    }

    /// The training in the run's folder at `path` goes on.
    ///
    /// # Errors
    /// It holds no run, or one that cannot be used.
    pub(super) fn resume(&mut self, world: &mut World, path: &Path) -> Result<(), RunError> {
        let (folder, config) = RunFolder::open(path)?;
        let Loaded { standing, learner, passed_over } = checkpoint::load(&folder, &config)?;
        let rows: Vec<EpisodeRow> = folder.rows("episodes.csv")?;
        let mut evaluations: Vec<EvaluationRow> = folder.rows("evaluations.csv")?;
        let (known, env_steps) = (learner.episodes(), learner.env_steps());
        let journal = Journal::of(&folder, &config, &learner)?;
        // It goes on without knowing what it started from; only a replay would not.
        let init = journal::init(&folder, &journal.begun).ok().flatten();
        self.replace(world, Beginning { config, init, learner, standing });
        self.journal = journal;
        self.saved_at = Some(env_steps);
        checkpoint::restore(world, &self.standing);
        let curves = &mut world.resource_mut::<Curves>().0;
        rows.iter().filter(|row| row.episode <= known).for_each(|row| curves.episode(row));
        evaluations.retain(|row| row.env_steps <= env_steps);
        evaluations.iter().for_each(|row| curves.evaluation(row));
        self.evaluations = evaluations;
        for (_, error) in passed_over {
            self.tell(Weight::Failed, format!("{error}; the checkpoint before it is taken instead"));
        }
        Ok(())
    }
}
