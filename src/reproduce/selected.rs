//! The selected experiments, and what they need: how much training, and at which points a policy is tested.

use std::collections::BTreeMap;
use std::path::Path;

use super::claim::Claim;
use super::experiment::Experiment;
use super::figure_spec::FigureKind;
use super::measure::Measure;
use super::table_spec::TableKind;
use super::test_point::{TestPoint, contrast_points, shorter};
use crate::run::preset::Budget;

/// An experiment and its source.
#[derive(Clone, Debug)]
pub struct ExperimentSource {
    /// The file, or a shipped experiment's path in the repository.
    pub from: String,
    /// The experiment.
    pub experiment: Experiment,
}

impl ExperimentSource {
    /// The experiment's name: its file name without the extension.
    #[must_use]
    pub fn name(&self) -> String {
        Path::new(&self.from).file_stem().unwrap_or_default().to_string_lossy().into_owned()
    }
}

/// An experiment with its selected figures and tables.
#[derive(Clone, Debug)]
pub struct SelectedExperiment {
    /// The experiment and its source.
    pub source: ExperimentSource,
    /// Indices of the selected figures.
    pub figures: Vec<usize>,
    /// Indices of the selected tables.
    pub tables: Vec<usize>,
}

impl SelectedExperiment {
    /// The names of the selected figures and tables.
    pub fn items(&self) -> impl Iterator<Item = &str> {
        let experiment = &self.source.experiment;
        let figures = self.figures.iter().map(|&i| experiment.figures[i].name.as_str());
        figures.chain(self.tables.iter().map(|&i| experiment.tables[i].name.as_str()))
    }

    /// Whether a selected figure, table or claim is about `arm`.
    #[must_use]
    pub fn needs(&self, arm: &str) -> bool {
        self.has_curves() || !self.points(arm).is_empty()
    }

    fn has_curves(&self) -> bool {
        let mut figures = self.figures.iter().map(|&i| &self.source.experiment.figures[i].draw);
        figures.any(|figure| matches!(figure, FigureKind::LearningCurves { .. }))
    }

    /// Whether a selected figure, table or claim is about the benchmark route.
    #[must_use]
    pub fn needs_benchmark_route(&self) -> bool {
        let is_route = |&measure: &Measure| measure == Measure::BenchmarkRouteTime;
        let of_claims = |claims: &[Claim]| claims.iter().any(|claim| is_route(&claim.measure));
        let mut figures = self.figures.iter().map(|&i| &self.source.experiment.figures[i]);
        let mut tables = self.tables.iter().map(|&i| &self.source.experiment.tables[i]);
        let in_figures = figures.any(|figure| {
            of_claims(&figure.claims)
                || match &figure.draw {
                    FigureKind::LearningCurves { .. } => false,
                    FigureKind::DotPlot { measures, .. } => measures.iter().any(is_route),
                    FigureKind::BenchmarkRoute { .. } => true,
                }
        });
        in_figures
            || tables.any(|table| {
                of_claims(&table.claims)
                    || match &table.show {
                        TableKind::Seeds { measure, .. } => is_route(measure),
                        TableKind::Rounds { .. } => false,
                        TableKind::Measures { measures, .. } | TableKind::Contrast { measures, .. } => {
                            measures.iter().any(is_route)
                        }
                    }
            })
    }

    /// How much of `arm` must be trained; `None` for all of it.
    #[must_use]
    pub fn needed_length(&self, arm: &str) -> Option<Budget> {
        if self.has_curves() {
            return None;
        }
        // The stages before the last one must be complete, so a length within the last stage is not the length of the arm.
        let length = |point: &TestPoint| point.after.filter(|_| !point.of_last_stage);
        let lengths: Vec<Budget> = self.points(arm).keys().map(length).collect::<Option<_>>()?;
        let longest = lengths.iter().copied().max()?;
        let longest = match longest {
            // Even the initial policy needs a training run.
            Budget::Episodes(0) => Budget::Episodes(1),
            Budget::EnvSteps(0) => Budget::EnvSteps(1),
            longest => longest,
        };
        lengths.iter().all(|&length| shorter(length, longest).is_some()).then_some(longest)
    }

    /// The points of `arm` that the selected figures, tables and claims are about, and whether each needs a policy.
    #[must_use]
    pub fn points(&self, arm: &str) -> BTreeMap<TestPoint, bool> {
        let experiment = &self.source.experiment;
        let mut points = BTreeMap::new();
        let mut add =
            |point: TestPoint, needs_policy: bool| *points.entry(point).or_default() |= needs_policy;
        let tested = |measures: &[Measure]| measures.iter().any(|measure| measure.needs_test());
        let mut claims: Vec<&Claim> = Vec::new();
        for figure in self.figures.iter().map(|&i| &experiment.figures[i]) {
            match &figure.draw {
                FigureKind::LearningCurves { .. } => {}
                FigureKind::DotPlot { measures, after } => add(TestPoint::overall(*after), tested(measures)),
                FigureKind::BenchmarkRoute { after } => add(TestPoint::overall(*after), true),
            }
            claims.extend(&figure.claims);
        }
        for table in self.tables.iter().map(|&i| &experiment.tables[i]) {
            match &table.show {
                TableKind::Seeds { measure, after, .. } => {
                    add(TestPoint::overall(*after), measure.needs_test());
                }
                TableKind::Rounds { after, .. } => add(TestPoint::overall(*after), true),
                TableKind::Measures { measures, after } => add(TestPoint::overall(*after), tested(measures)),
                TableKind::Contrast { better, than, .. } if better != arm && than != arm => {}
                TableKind::Contrast { measures, after, of_last_stage, .. } => {
                    for point in contrast_points(after, *of_last_stage) {
                        add(point, tested(measures));
                    }
                }
            }
            claims.extend(&table.claims);
        }
        for claim in claims.into_iter().filter(|claim| claim.better == arm || claim.than == arm) {
            add(claim.point(), claim.measure.needs_test());
        }
        points
    }
}
