//! A test in one scenario, in which all policies and drivers drive the same episodes.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::EvalArgs;
use super::files::{TestEnd, TestFile};
use super::report::{BenchmarkRouteReport, OptimumReport, PolicyReport};
use crate::cli::driver::TestDriver;
use crate::planner::{StepBounds, unsupported_reason};
use crate::policy::Policy;
use crate::run::RunError;
use crate::run::evaluate::{self, EpisodeRecord, EpisodeResult, Evaluation, Evaluator, OptimumComparison};
use crate::run::progress::print_stderr;
use crate::run::provenance::Provenance;
use crate::scenario::{BenchmarkRoute, Scenario, printable};
use crate::simulation::Extensions;
use crate::task::EpisodeSetup;

/// The number of episodes that the planner gets between two checks for signals.
const PLANNED_AT_ONCE: usize = 64;

/// A policy or driver under test, with its file or shipped name.
pub type Named = (String, TestDriver);

/// A test in one scenario.
pub struct Test<'a> {
    pub scenario: Arc<Scenario>,
    /// The number of episodes.
    pub count: usize,
    /// The number of episodes per round.
    pub per_round: usize,
    pub seed: u64,
    /// The benchmark route, if it is to be driven.
    pub route: Option<BenchmarkRoute>,
    pub args: &'a EvalArgs,
    pub extensions: &'a Extensions,
    /// The flag by which a signal stops the test, if it writes files.
    pub stop: Option<&'static AtomicBool>,
}

/// What the planner knows about the episodes of a test.
struct References {
    shortest_paths_m: Vec<f64>,
    /// Bounds of all episodes, if they are needed and the test writes files.
    bounds: Option<Vec<StepBounds>>,
}

impl Test<'_> {
    /// Tests `policies` one after the other, and writes their episodes and steps to the files.
    pub fn run(
        &self,
        policies: &[Named],
        mut csv: Option<&mut TestFile>,
        mut trace: Option<&mut TestFile>,
    ) -> Result<Vec<PolicyReport>, TestEnd> {
        if self.args.optimum
            && let Some(reason) = unsupported_reason(&self.scenario)
        {
            let name = printable(&self.scenario.name);
            print_stderr(&format!("note: no optimal times in {name}: the planner does not support {reason}"));
        }
        // A trace has one episode after the other. The number of parallel episodes changes no result.
        let parallel = if trace.is_some() { 1 } else { self.count };
        let mut evaluator =
            Evaluator::with_extensions(&self.scenario, parallel, self.extensions).measuring_paths();
        let mut references = None;
        let mut reports = Vec::new();
        for named in policies {
            let episodes = self.episodes(&mut evaluator, named, trace.as_deref_mut())?;
            // The references are the same for every policy.
            let references = match &mut references {
                Some(references) => references,
                none => none.insert(self.references(&episodes)?),
            };
            if let Some(csv) = &mut csv {
                csv.rows(self.records(&named.0, &episodes, references), reports.is_empty())?;
            }
            reports.push(self.report(named, &episodes, references)?);
        }
        Ok(reports)
    }

    fn episodes(
        &self,
        evaluator: &mut Evaluator,
        (name, driver): &Named,
        trace: Option<&mut TestFile>,
    ) -> Result<Vec<EpisodeResult>, TestEnd> {
        let (seed, count, setup) = (self.seed, self.count, EpisodeSetup::Random);
        if let Some(trace) = trace {
            return evaluator.run_traced(driver.evaluated(), seed, count, setup, |step| {
                self.check_not_stopped()?;
                trace.step(name, &step)
            });
        }
        let mut run = evaluator.start(driver.evaluated(), seed, count, setup)?;
        while !evaluator.step(&mut run)? {
            self.check_not_stopped()?;
        }
        Ok(run.episodes)
    }

    fn check_not_stopped(&self) -> Result<(), RunError> {
        match self.stop {
            Some(stop) if stop.load(Ordering::Relaxed) => {
                Err(RunError::Stopped("stopped before the end of the test; no file was written".into()))
            }
            _ => Ok(()),
        }
    }

    fn references(&self, episodes: &[EpisodeResult]) -> Result<References, RunError> {
        // A test that writes files computes the bounds here, where a signal can stop it.
        let has_bounds = self.args.optimum && self.stop.is_some();
        let mut references = References { shortest_paths_m: Vec::new(), bounds: has_bounds.then(Vec::new) };
        // Some plans take seconds, so the stop flag is checked between chunks.
        for chunk in episodes.chunks(PLANNED_AT_ONCE) {
            self.check_not_stopped()?;
            references.shortest_paths_m.extend(evaluate::shortest_paths_m(&self.scenario, chunk, 0));
            if let Some(bounds) = &mut references.bounds {
                bounds.extend(evaluate::bounds(&self.scenario, chunk, 0));
            }
        }
        self.check_not_stopped()?;
        Ok(references)
    }

    fn records<'a>(
        &'a self,
        policy: &'a str,
        episodes: &'a [EpisodeResult],
        references: &'a References,
    ) -> impl Iterator<Item = EpisodeRecord> + 'a {
        episodes.iter().zip(&references.shortest_paths_m).enumerate().map(
            move |(index, (episode, shortest_m))| {
                let bounds = references.bounds.as_ref().and_then(|bounds| bounds.get(index).copied());
                EpisodeRecord::new(policy, index + 1, episode, &self.scenario, *shortest_m, bounds)
            },
        )
    }

    fn report(
        &self,
        (name, driver): &Named,
        episodes: &[EpisodeResult],
        references: &References,
    ) -> Result<PolicyReport, RunError> {
        let Self { scenario, seed, .. } = self;
        let spl = episodes
            .iter()
            .zip(&references.shortest_paths_m)
            .filter_map(|(e, shortest_m)| e.spl(*shortest_m));
        let compare = || match &references.bounds {
            Some(bounds) => OptimumComparison::from_episodes(episodes, bounds, &scenario.task),
            None => evaluate::compare_with_optimum(scenario, episodes),
        };
        let evaluated = driver.evaluated();
        let on_route = |route| BenchmarkRouteReport::new(scenario, route, evaluated, *seed, self.extensions);
        Ok(PolicyReport {
            policy: name.clone(),
            class: evaluated.class(),
            physics: evaluate::PHYSICS,
            weights_crc32c: driver.policy().map(Policy::weights_crc32c),
            provenance: Provenance::of(scenario),
            scenario: scenario.name.clone(),
            evaluation: Evaluation::from_episodes(episodes, self.per_round, &scenario.task, *seed),
            spl: spl.sum::<f64>() / episodes.len() as f64,
            benchmark_route: self.route.map(on_route).transpose()?,
            optimum: self
                .args
                .optimum
                .then(|| OptimumReport::new(compare(), unsupported_reason(scenario).is_none())),
        })
    }
}
