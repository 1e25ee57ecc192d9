//! The results of a test, as JSON objects.

use std::sync::Arc;

use serde::Serialize;

use crate::drivers::DriverClass;
use crate::run::RunError;
use crate::run::evaluate::{self, Evaluated, Evaluation, Evaluator, OptimumComparison};
use crate::run::provenance::Provenance;
use crate::run::shipped;
use crate::scenario::{BenchmarkRoute, Scenario};
use crate::simulation::Extensions;
use crate::task::EpisodeSetup;

/// The number of episodes on the benchmark route (the paper: 5 rounds of 5).
pub const ROUTE_EPISODES: usize = 25;

/// The results of one policy or driver: the JSON object that `--eval --json` prints.
#[derive(Serialize)]
pub struct PolicyReport {
    pub policy: String,
    /// What the policy or driver may perceive: `A`, `B` or `C`.
    pub class: DriverClass,
    pub physics: &'static str,
    /// `None` for a classical driver.
    pub weights_crc32c: Option<String>,
    #[serde(flatten)]
    pub provenance: Provenance,
    pub scenario: String,
    #[serde(flatten)]
    pub evaluation: Evaluation,
    /// Mean success weighted by path length, 0 to 1.
    pub spl: f64,
    #[serde(flatten)]
    pub benchmark_route: Option<BenchmarkRouteReport>,
    #[serde(flatten)]
    pub optimum: Option<OptimumReport>,
}

/// The results of several policies in the same episodes: the JSON object that `--eval --json` prints for them.
#[derive(Serialize)]
pub struct ComparisonReport<'a> {
    pub scenario: &'a str,
    pub episodes: usize,
    pub seed: u64,
    pub policies: &'a [PolicyReport],
}

impl<'a> ComparisonReport<'a> {
    /// The comparison of `policies`; `None` without policies.
    pub fn new(policies: &'a [PolicyReport]) -> Option<Self> {
        let first = policies.first()?;
        let Evaluation { episodes, seed, .. } = first.evaluation;
        Some(Self { scenario: &first.scenario, episodes, seed, policies })
    }
}

/// The policy's results on the benchmark route.
#[derive(Serialize)]
pub struct BenchmarkRouteReport {
    pub course_success_rate: f64,
    pub course_success_interval: [f64; 2],
    pub course_time_s: Option<f64>,
    pub course_times_s: Vec<f64>,
    /// Whether the scenario is the paper's Scenario I, so that the paper's time can be compared.
    #[serde(skip)]
    pub in_paper_scenario: bool,
}

impl BenchmarkRouteReport {
    /// Drives `route` in `scenario`.
    ///
    /// # Errors
    /// The policy does not fit the scenario.
    pub fn new(
        scenario: &Arc<Scenario>,
        route: BenchmarkRoute,
        evaluated: Evaluated,
        seed: u64,
        extensions: &Extensions,
    ) -> Result<Self, RunError> {
        let mut evaluator = Evaluator::with_extensions(scenario, ROUTE_EPISODES, extensions);
        let episodes = evaluator.run(evaluated, seed, ROUTE_EPISODES, EpisodeSetup::Route(route))?;
        let evaluation = Evaluation::from_episodes(&episodes, ROUTE_EPISODES, &scenario.task, seed);
        let times_s: Vec<f64> = evaluate::times_s(&episodes, scenario.task.control_period_s).collect();
        Ok(Self {
            course_success_rate: evaluation.success_rate,
            course_success_interval: evaluation.success_interval,
            course_time_s: evaluation.mean_time_s,
            course_times_s: times_s,
            in_paper_scenario: shipped::is_paper_scenario_1(scenario),
        })
    }
}

/// The policy's times, compared with the optimal ones.
#[derive(Serialize)]
pub struct OptimumReport {
    pub optimum_episodes: usize,
    pub optimum_mean_time_s: Option<f64>,
    pub time_ratio: Option<f64>,
    /// Whether the planner supports the scenario. If not, the test has printed why.
    #[serde(skip)]
    pub is_supported: bool,
}

impl OptimumReport {
    /// The report on `comparison`, which is `None` if no episode could be compared. `is_supported` is whether the planner
    /// supports the scenario.
    pub fn new(comparison: Option<OptimumComparison>, is_supported: bool) -> Self {
        Self {
            is_supported,
            optimum_episodes: comparison.map_or(0, |c| c.episodes),
            optimum_mean_time_s: comparison.map(|c| c.optimum_mean_time_s),
            time_ratio: comparison.map(|c| c.time_ratio),
        }
    }
}
