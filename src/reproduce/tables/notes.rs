//! The notes below a table: how its numbers were obtained.

use crate::report::format::number;
use crate::reproduce::experiment::{Experiment, TestedPolicy};
use crate::reproduce::measure::Measure;
use crate::reproduce::policy_test::BENCHMARK_ROUTE_EPISODES;
use crate::reproduce::table_spec::{TableKind, TableSpec};

/// The notes of a table: the test, the intervals, the policies and the measures.
pub(super) fn notes(experiment: &Experiment, spec: &TableSpec) -> Vec<String> {
    let measures: &[Measure] = match &spec.show {
        TableKind::Seeds { measure, .. } => std::slice::from_ref(measure),
        TableKind::Rounds { .. } => &[Measure::Success],
        TableKind::Measures { measures, .. } | TableKind::Contrast { measures, .. } => measures,
    };
    let mut notes = vec![test_note(experiment, spec)];
    for arm in experiment.arms.iter().filter(|arm| arm.policy == TestedPolicy::Best) {
        notes.push(format!(
            "{}: the best policy of its training, by the evaluations during training.",
            arm.name
        ));
    }
    notes.extend(measure_notes(experiment, measures));
    notes
}

fn test_note(experiment: &Experiment, spec: &TableSpec) -> String {
    let after = match &spec.show {
        TableKind::Seeds { after, .. }
        | TableKind::Rounds { after, .. }
        | TableKind::Measures { after, .. } => Some(after),
        TableKind::Contrast { .. } => None,
    };
    let at_episode = experiment.arms.iter().any(|arm| arm.policy == TestedPolicy::AtEpisode);
    let mut note = match after.filter(|_| at_episode) {
        Some(after) => format!("Greedy policy after {} episodes", number(*after as f64, 0)),
        None => "Greedy policy".into(),
    };
    let seeds = experiment.seeds;
    note += &format!(", {seeds} seed{}", if seeds == 1 { "" } else { "s" });
    if !matches!(spec.show, TableKind::Rounds { .. }) {
        note += "; ± is the 95 % interval of the mean over the seeds (Student's t)";
    }
    if matches!(&spec.show, TableKind::Seeds { paper, .. } if !paper.is_empty()) {
        note += "; the paper's value is taken as exact";
    }
    note + "."
}

/// A note for each measure that needs an explanation.
fn measure_notes(experiment: &Experiment, measures: &[Measure]) -> Vec<String> {
    let mut notes = Vec::new();
    if measures.contains(&Measure::Success) {
        notes.push(format!(
            "Success: the share of successful episodes. Each seed's policy is tested in {} rounds of {} episodes that it \
             was not trained on.",
            experiment.test.rounds, experiment.test.episodes
        ));
    }
    if measures.contains(&Measure::BenchmarkRouteTime) {
        notes.push(format!(
            "Benchmark route: the mean time of {BENCHMARK_ROUTE_EPISODES} episodes of each seed's policy; a failed \
             episode counts as the time limit. Without moving obstacles and noise, all episodes of a policy are equal."
        ));
    }
    if measures.contains(&Measure::MeanTime) {
        notes.push("Mean time: over all test episodes; a failed episode counts as the time limit.".into());
    }
    if measures.contains(&Measure::TimeRatio) {
        notes.push(
            "Time / optimal: the total time of the successful test episodes over the planner's time for the same \
             episodes. If a policy often fails, these are the easy episodes."
                .into(),
        );
    }
    if measures.contains(&Measure::BoundRatio) {
        notes.push(
            "Time / lower bound: the same total time over the proven lower bounds of the optimal time."
                .into(),
        );
    }
    if measures.iter().any(|m| matches!(m, Measure::Return | Measure::Goals)) {
        notes.push(
            "Return, goals: the mean of the last 100 training episodes, which still include exploration."
                .into(),
        );
    }
    if measures.iter().any(|m| matches!(m, Measure::EpisodesTo(_) | Measure::StepsTo(_))) {
        notes.push(
            "Episodes (steps) to a number of goals: those of the last stage until the moving mean over 50 training \
             episodes reaches it. \"> n\": some seeds never reached it and count with the length of their run."
                .into(),
        );
    }
    notes
}
