//! Unit tests: the shipped experiments can be planned, shared trainings are planned once, and measures are computed
//! from the records.

use std::path::{Path, PathBuf};

use super::ReproduceOptions;
use super::experiment::{Experiment, TestRule};
use super::figure_spec::EpisodeSeries;
use super::measure::Measure;
use super::measured_value::MeasuredValue;
use super::optimal_times::OptimalTimesCache;
use super::overrides::Override;
use super::plan::{ArmRun, PolicyId, RunPlan, Training};
use super::policy_test::{self, PolicyTestResult};
use super::results::Results;
use super::select::select;
use super::selected::SelectedExperiment;
use super::table_spec::TableKind;
use crate::run::folder::RunFolder;
use crate::run::metric_rows::{EpisodeRow, EvaluationRow};
use crate::run::preset::Budget;
use crate::run::settings::Settings;

fn only(names: &[&str]) -> ReproduceOptions {
    ReproduceOptions { only: names.iter().map(|&name| name.into()).collect(), ..ReproduceOptions::default() }
}

fn planned(options: &ReproduceOptions) -> (Vec<SelectedExperiment>, RunPlan) {
    let selected = select(options).expect("the selection works");
    let plan = RunPlan::new(&selected).expect("the plan works");
    (selected, plan)
}

fn budgets(plan: &RunPlan, seed: u64) -> Vec<(String, Budget)> {
    let of_seed = plan.trainings.iter().filter(|training| training.config.seed == seed);
    of_seed.map(|training| (training.config.preset_name(), training.config.preset.budget)).collect()
}

#[test]
fn all_shipped_experiments_can_be_planned_in_full_and_quickly() {
    let (all, plan) = planned(&ReproduceOptions::default());
    assert_eq!(all.len(), 8);
    let (quick, quick_plan) = planned(&ReproduceOptions { quick: true, ..ReproduceOptions::default() });
    assert_eq!(
        plan.trainings.len() / 5,
        quick_plan.trainings.len() / 2,
        "the number of trainings per seed is the same"
    );
    for selected in quick {
        let experiment = &selected.source.experiment;
        assert!(
            experiment.diagnostics().is_empty(),
            "{}: {:?}",
            selected.source.from,
            experiment.diagnostics()
        );
        assert_eq!(experiment.seeds, 2);
    }
    for (index, training) in plan.trainings.iter().enumerate() {
        assert!(
            training.origin.is_none_or(|from| from < index),
            "origins precede the trainings that start from them"
        );
    }
}

#[test]
fn a_training_shared_by_experiments_is_planned_once() {
    // Figure 8's DQN is the beginning of figure 9's; figure 10's transfer starts from figure 9's PER-D3QN.
    let (_, plan) = planned(&only(&["fig8", "fig9", "fig10"]));
    assert_eq!(
        budgets(&plan, 3),
        [
            ("dqn".into(), Budget::Episodes(1500)),
            ("dqn".into(), Budget::Episodes(800)),
            ("per_d3qn".into(), Budget::Episodes(1500)),
            ("per_d3qn".into(), Budget::Episodes(2000)),
            ("per_d3qn".into(), Budget::Episodes(1000)),
        ]
    );
    let transferred = plan
        .trainings
        .iter()
        .find(|t| t.config.transfer.is_some())
        .expect("one training starts from weights");
    let origin = &plan.trainings[transferred.origin.expect("it has an origin")];
    assert_eq!(origin.config.scenario.name, "Scenario I");
    assert!(
        origin.config.save_policy_after_episodes.contains(&1000),
        "the policy that it starts from is saved"
    );
    let mut names: Vec<&str> = plan.trainings.iter().map(|training| training.name.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), plan.trainings.len(), "every training has its own folder");
}

#[test]
fn only_needed_episodes_and_seeds_are_trained() {
    let (_, plan) = planned(&only(&["table2"]));
    assert_eq!(
        budgets(&plan, 1),
        [("dqn".into(), Budget::Episodes(1000)), ("per_d3qn".into(), Budget::Episodes(1000))]
    );
    assert_eq!(plan.trainings.len(), 10, "five seeds");
    assert_eq!(plan.trainings[0].tests.len(), 1, "one test each");
    let (selected, _) = planned(&only(&["table7"]));
    let table = selected[0].tables.iter().map(|&i| &selected[0].source.experiment.tables[i].name);
    assert_eq!(table.collect::<Vec<_>>(), ["table6-7"], "a table is found by each of its aliases");
    let (_, plan) = planned(&ReproduceOptions { seeds: Some(2), ..only(&["fig8"]) });
    assert_eq!(plan.trainings.len(), 4);
}

#[test]
fn episodes_are_counted_over_all_stages() {
    let stages = vec![(0, Some(1000)), (1, Some(800))];
    let arm_run = ArmRun { stages };
    assert_eq!(arm_run.stage_at(400), Some((0, 400)));
    assert_eq!(arm_run.stage_at(1000), Some((0, 1000)), "the last episode of a stage belongs to it");
    assert_eq!(arm_run.stage_at(1001), Some((1, 1)));
    assert_eq!(arm_run.stage_at(1800), Some((1, 800)));
    assert_eq!(arm_run.stage_at(1801), None);
}

const TWO_STAGES: &str = r#"(
    title: "t",
    seeds: 1,
    test: (rounds: 1, episodes: 4, seed: 5),
    arms: [
        (
            name: "a",
            stages: [
                (scenario: "empty", preset: "dqn", budget: Episodes(100)),
                (scenario: "scenario-1", preset: "dqn", budget: Episodes(200)),
            ],
        ),
    ],
    tables: [(name: "t", title: "t", show: Seeds(measure: Success, after: 300))],
)"#;

/// Writes the records of a run with the given goals per episode; every episode has 10 steps and a return of 100 per goal.
fn write_records(folder: &Path, training: &Training, goals: &[u32], results: &[PolicyTestResult]) {
    let folder =
        RunFolder::create(Some(folder.join(&training.name)), &training.config, None).expect("a folder");
    let mut episodes = folder.csv::<EpisodeRow>("episodes.csv", 0, &[]).expect("a file");
    folder.csv::<EvaluationRow>("evaluations.csv", 0, &[]).expect("a file");
    for (i, &goals) in (1..).zip(goals) {
        let total_return = 100.0 * f64::from(goals);
        let row = EpisodeRow { episode: i, env_steps: 10 * i, goals, total_return, ..EpisodeRow::default() };
        episodes.serialize(row).expect("a row");
    }
    episodes.flush().expect("written");
    policy_test::write_results(&folder, results).expect("written");
}

#[test]
fn measures_are_computed_from_the_records() {
    let folder = tempfile::tempdir().expect("a folder");
    let file: PathBuf = folder.path().join("two.ron");
    std::fs::write(&file, TWO_STAGES).expect("written");
    let (selected, plan) =
        planned(&ReproduceOptions { experiments: vec![file], ..ReproduceOptions::default() });
    assert_eq!(plan.trainings.len(), 2);

    // No goals in the first stage. In the second, none in 100 episodes, then 4 in each of another 100.
    let second: Vec<u32> = (0..200).map(|i| if i < 100 { 0 } else { 4 }).collect();
    let result = PolicyTestResult {
        policy: policy_test::policy_file(PolicyId::AfterEpisodes(200)),
        rule: TestRule { rounds: 1, episodes: 4, seed: 5 },
        steps: vec![Some(50), None, Some(70), Some(60)],
        collisions: 1,
        benchmark_route_steps: vec![Some(60); policy_test::BENCHMARK_ROUTE_EPISODES],
    };
    write_records(folder.path(), &plan.trainings[0], &[0; 100], &[]);
    write_records(folder.path(), &plan.trainings[1], &second, &[result]);
    let optimal_times = OptimalTimesCache::new(folder.path().join("optimum"));
    let results =
        Results::read(&plan, &selected, folder.path(), optimal_times).expect("the results are read");
    let value = |measure, after| {
        let values = results.values(0, 0, 0, measure, after).expect("the value is known");
        assert_eq!(values.len(), 1);
        values[0]
    };
    let exactly = |value| MeasuredValue { value, is_lower_bound: false };
    assert_eq!(value(Measure::Success, 300), exactly(75.0), "3 of 4");
    // (50 + 500 + 70 + 60) / 4 = 170 steps of 0.2 s: a failure counts as the time limit of 500 steps.
    assert_eq!(value(Measure::MeanTime, 300), exactly(34.0));
    assert_eq!(value(Measure::BenchmarkRouteTime, 300), exactly(12.0), "60 steps");
    // The last 100 episodes.
    assert_eq!(value(Measure::Goals, 300), exactly(4.0));
    assert_eq!(value(Measure::Return, 300), exactly(400.0));
    assert_eq!(value(Measure::Goals, 200), exactly(0.0), "after the first 100 episodes of the second stage");
    // The mean of 50 episodes is 4 n / 50 after n episodes with goals: 2 at n = 25, the 125th episode of the stage.
    assert_eq!(value(Measure::EpisodesTo(2.0), 300), exactly(125.0));
    assert_eq!(value(Measure::StepsTo(2.0), 300), exactly(1.25), "thousands of steps");
    let not_reached = MeasuredValue { value: 200.0, is_lower_bound: true };
    assert_eq!(value(Measure::EpisodesTo(4.5), 300), not_reached, "a lower bound");

    assert_eq!(results.rounds(0, 0, 0, 1, 300).expect("the value is known"), [75.0], "one round");

    let curve = &results.curves(0, 0, 0, EpisodeSeries::Goals)[0];
    assert_eq!((curve.len(), curve[99], curve[299]), (300, 0.0, 4.0), "the stages follow each other");
}

#[test]
fn overrides_change_every_field_they_name() {
    let text = TWO_STAGES.replace(
        "budget: Episodes(200))",
        "budget: Episodes(200), overrides: (lidar_noise_std_m: 0.05, actuator_lag_s: 0.3, collision_range_m: 0.15,
            max_episode_steps: 300, reward: Traditional, l_r_m: 0.5, observation: Raw, double: true, dueling: true,
            sampling: Prioritized(alpha: 0.6, beta: Constant(0.4), importance_weights: true, epsilon: 0.01),
            alpha: 0.7))",
    );
    let experiment = Experiment::parse(&text, "two.ron").expect("a valid experiment");
    let overrides = &experiment.arms[0].stages[1].overrides;
    let mut scenario = crate::run::shipped::scenario("scenario-2").expect("shipped");
    let mut preset = crate::run::shipped::preset("dqn").expect("shipped");
    let faster = Override { orbit_speed_rad_s: Some(0.3), ..overrides.clone() };
    faster.apply(&mut scenario, &mut preset);
    let text = crate::scenario::to_ron(&(scenario, preset)).expect("RON");
    for field in [
        "noise_std_m: 0.05",
        "actuator_lag_s: 0.3",
        "collision_range_m: 0.15",
        "max_episode_steps: 300",
        "kind: Traditional",
        "l_r_m: 0.5",
        "observation: Raw",
        "double: true",
        "dueling: true",
        "alpha: 0.7",
        "importance_weights: true",
    ] {
        assert_eq!(text.matches(field).count(), 1, "{field} in {text}");
    }
    assert_eq!(text.matches("speed_rad_s: 0.3").count(), 4, "all four cylinders");
    assert!(matches!(experiment.tables[0].show, TableKind::Seeds { after: 300, .. }));
}

#[test]
fn settings_from_the_command_line_change_all_trainings() {
    let (_, plan) = planned(&only(&["fig8"]));
    let settings = ["learning.gamma=0.97", "scenario.lidar.noise_std_m=0.02"];
    let settings = Settings(settings.iter().map(|text| text.parse().expect("a setting")).collect());
    let (_, changed) = planned(&ReproduceOptions { settings, ..only(&["fig8"]) });
    assert_eq!(changed.trainings.len(), plan.trainings.len());
    for (training, before) in changed.trainings.iter().zip(&plan.trainings) {
        assert_eq!(training.config.preset.learning.gamma, 0.97);
        assert_eq!(training.config.scenario.lidar.noise_std_m, 0.02);
        assert_ne!(training.name, before.name, "a run without the settings is another run");
    }
}
