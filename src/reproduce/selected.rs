//! The selected experiments, and what they need: how many episodes, and at which points a policy is tested.

use std::collections::BTreeSet;
use std::path::Path;

use super::claim::Claim;
use super::experiment::Experiment;
use super::figure_spec::FigureKind;
use super::measure::Measure;
use super::table_spec::TableKind;

/// An experiment and its source.
#[derive(Clone, Debug)]
pub struct ExperimentSource {
    /// The file, or the path in the repository of a shipped experiment.
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

/// A number of episodes after which an arm is tested.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct TestPoint {
    /// The number of episodes.
    pub after: u64,
    /// Whether the episodes are those of the last stage only.
    pub of_last_stage: bool,
}

impl SelectedExperiment {
    /// The number of episodes that are needed of each arm; `None` for all.
    #[must_use]
    pub fn needed_episodes(&self) -> Option<u64> {
        let mut figures = self.figures.iter().map(|&i| &self.source.experiment.figures[i].draw);
        let curves = figures.any(|figure| matches!(figure, FigureKind::LearningCurves { .. }));
        let points = self.test_points();
        // The last stage starts when all stages before it are complete.
        let of_last_stage = points.iter().any(|point| point.of_last_stage);
        if curves || of_last_stage { None } else { points.last().map(|point| point.after) }
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

    /// The points at which the selected figures, tables and claims need a policy.
    #[must_use]
    pub fn test_points(&self) -> BTreeSet<TestPoint> {
        let experiment = &self.source.experiment;
        let mut points = BTreeSet::new();
        let overall = |after| TestPoint { after, of_last_stage: false };
        let of_claim = |claim: &Claim| TestPoint { after: claim.after, of_last_stage: claim.of_last_stage };
        for figure in self.figures.iter().map(|&i| &experiment.figures[i]) {
            match &figure.draw {
                FigureKind::LearningCurves { .. } => {}
                FigureKind::DotPlot { after, .. } | FigureKind::BenchmarkRoute { after } => {
                    points.insert(overall(*after));
                }
            }
            points.extend(figure.claims.iter().map(of_claim));
        }
        for table in self.tables.iter().map(|&i| &experiment.tables[i]) {
            match &table.show {
                TableKind::Seeds { after, .. }
                | TableKind::Rounds { after, .. }
                | TableKind::Measures { after, .. } => {
                    points.insert(overall(*after));
                }
                TableKind::Contrast { after, of_last_stage, .. } => {
                    let of_last_stage = *of_last_stage;
                    points.extend(after.iter().map(|&after| TestPoint { after, of_last_stage }));
                }
            }
            points.extend(table.claims.iter().map(of_claim));
        }
        points
    }
}
