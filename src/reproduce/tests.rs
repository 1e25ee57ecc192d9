//! Unit tests: the shipped experiments can be planned, shared training runs are planned once, and measures are computed
//! from the records.

use std::path::{Path, PathBuf};

use super::ReproduceOptions;
use super::arm_run::{ArmRun, PolicyId};
use super::elsewhere::FinishedRun;
use super::experiment::TestRule;
use super::figure_spec::{Axis, Series};
use super::figures::caption;
use super::learning_curves::{StageChange, merged_markers};
use super::measure::Measure;
use super::measured_value::MeasuredValue;
use super::optimal_times::OptimalTimesCache;
use super::plan::{PlannedRun, RunPlan};
use super::policy_test::{self, PolicyTestResult};
use super::progress::gradient_steps;
use super::records::Windows;
use super::report_progress::ReportProgress;
use super::results::{ArmIndex, Results};
use super::seeds::Seeds;
use super::select::select;
use super::selected::SelectedExperiment;
use super::shard::Shard;
use super::test_point::TestPoint;
use crate::learning::Sampling;
use crate::run::folder::RunFolder;
use crate::run::metric_rows::{EpisodeRow, EvaluationRow};
use crate::run::preset::Budget;
use crate::run::settings::Settings;
use crate::task::RewardKind;

fn only(names: &[&str]) -> ReproduceOptions {
    ReproduceOptions { only: names.iter().map(|&name| name.into()).collect(), ..ReproduceOptions::default() }
}

fn planned(options: &ReproduceOptions) -> (Vec<SelectedExperiment>, RunPlan) {
    let selected = select(options).expect("the selection works");
    let plan = RunPlan::new(&selected).expect("the plan works");
    (selected, plan)
}

fn budgets(plan: &RunPlan, seed: u64) -> Vec<(String, Budget)> {
    let of_seed = plan.training_runs.iter().filter(|training| training.config.seed == seed);
    of_seed.map(|training| (training.config.preset_name(), training.config.preset.budget)).collect()
}

#[test]
fn all_shipped_experiments_can_be_planned_in_full_and_quickly() {
    let (all, plan) = planned(&ReproduceOptions::default());
    assert_eq!(all.len(), 8);
    let (quick, quick_plan) = planned(&ReproduceOptions { quick: true, ..ReproduceOptions::default() });
    assert_eq!(
        plan.training_runs.len() / 5,
        quick_plan.training_runs.len() / 2,
        "the number of training runs per seed is the same"
    );
    for selected in quick {
        let experiment = &selected.source.experiment;
        assert!(
            experiment.diagnostics().is_empty(),
            "{}: {:?}",
            selected.source.from,
            experiment.diagnostics()
        );
        assert_eq!(experiment.seeds, Seeds::First(2));
    }
    for (index, training) in plan.training_runs.iter().enumerate() {
        assert!(
            training.origin.is_none_or(|from| from < index),
            "origins precede the runs that start from them"
        );
    }
}

fn quick_plan(text: &str) -> RunPlan {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("mine.ron");
    std::fs::write(&file, text).expect("written");
    planned(&ReproduceOptions { experiments: vec![file], quick: true, ..ReproduceOptions::default() }).1
}

#[test]
fn a_quick_version_shortens_budgets_and_evaluations_wherever_they_are_set() {
    let quick = |header: &str, stage: &str| {
        let plan = quick_plan(&format!(
            r#"(title: "T", {header}
                arms: [(name: "a", stages: [(scenario: "empty", preset: "fast", {stage})])],
                tables: [(name: "t", title: "T", show: Seeds(measure: Success))])"#
        ));
        let preset = &plan.training_runs[0].config.preset;
        (preset.budget, preset.evaluation.every_env_steps, preset.evaluation.episodes)
    };
    let tenth = Budget::EnvSteps(300);
    let (budget, of_preset) = ("budget: EnvSteps(3000)", Budget::EnvSteps(60_000));
    assert_eq!(quick("evaluation: (every_env_steps: 500, episodes: 4),", budget), (tenth, 50, 4));
    assert_eq!(quick("evaluation: (every_env_steps: 500, episodes: 100),", budget), (tenth, 50, 20));
    assert_eq!(quick("", budget), (tenth, 10_000, 20));
    assert_eq!(quick("", ""), (of_preset, 10_000, 20));
    let overrides = r#"overrides: {"budget": EnvSteps(3000), "evaluation.every_env_steps": 500}"#;
    assert_eq!(quick("", overrides), (tenth, 50, 20), "overrides of a stage");
    assert_eq!(quick(&format!("{overrides},"), ""), (tenth, 50, 20), "overrides of all stages");
    let conditions = format!(r#"conditions: [(name: "c", {overrides})],"#);
    assert_eq!(quick(&conditions, ""), (tenth, 50, 20), "overrides of a condition");
}

#[test]
fn the_stages_of_a_quick_version_are_long_enough_for_its_tests() {
    let text = TWO_STAGES
        .replace("Episodes(100)", "Episodes(15)")
        .replace("Episodes(200)", "Episodes(15)")
        .replace("Episodes(300)", "Episodes(30)");
    assert_eq!(
        budgets(&quick_plan(&text), 1),
        [("dqn".into(), Budget::Episodes(2)), ("dqn".into(), Budget::Episodes(1))],
        "3 episodes in all"
    );
}

#[test]
fn a_training_run_shared_by_experiments_is_planned_once() {
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
        .training_runs
        .iter()
        .find(|t| t.config.transfer.is_some())
        .expect("one run starts from a policy");
    let origin = &plan.training_runs[transferred.origin.expect("it has an origin")];
    assert_eq!(origin.config.scenario.name, "Scenario I");
    assert!(
        origin.config.save_policy_after.contains(&Budget::Episodes(1000)),
        "the policy that it starts from is saved"
    );
    let mut names: Vec<&str> = plan.training_runs.iter().map(|training| training.name.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), plan.training_runs.len(), "every training run has its own folder");
}

#[test]
fn shards_split_a_plan_equally_and_keep_transfers_together() {
    let (_, plan) = planned(&ReproduceOptions::default());
    let cost = |part: &RunPlan| -> f64 {
        part.training_runs.iter().map(|t| gradient_steps(t, t.config.preset.budget)).sum()
    };
    let chains = |number| format!("{number}/1000").parse::<Shard>().expect("a shard").of(&plan);
    let largest_chain = (1..=1000).map(|number| cost(&chains(number))).fold(0.0, f64::max);
    for count in [1, 2, 7, 40] {
        let mut names = Vec::new();
        for number in 1..=count {
            let shard: Shard = format!("{number}/{count}").parse().expect("a shard");
            let part = shard.of(&plan);
            let most = 1.001 * (cost(&plan) / f64::from(count) + largest_chain);
            assert!(cost(&part) <= most, "part {shard} costs more than an equal part plus the largest chain");
            for training in &part.training_runs {
                let whole = plan.training_runs.iter().find(|t| t.name == training.name).expect("in the plan");
                let origin =
                    |plan: &RunPlan, t: &PlannedRun| t.origin.map(|k| plan.training_runs[k].name.clone());
                assert_eq!(origin(&part, training), origin(&plan, whole), "{}", training.name);
                assert_eq!((&training.config, &training.tests), (&whole.config, &whole.tests));
            }
            names.extend(part.training_runs.into_iter().map(|training| training.name));
        }
        let mut all: Vec<String> = plan.training_runs.iter().map(|training| training.name.clone()).collect();
        all.sort();
        names.sort();
        assert_eq!(names, all, "every training run is in exactly one of {count} parts");
    }
    let part = "9/9".parse::<Shard>().expect("a shard").of(&planned(&only(&["fig8"])).1);
    assert!(part.training_runs.len() <= 2, "ten training runs in nine parts");
    for wrong in ["0/2", "3/2", "2", "1/0", "a/b", "1/2/3", "-1/2", "1/200000"] {
        assert!(wrong.parse::<Shard>().is_err_and(|why| why.starts_with("give K/N")), "{wrong}");
    }
}

#[test]
fn shards_do_not_count_training_that_was_done_elsewhere() {
    let (_, mut plan) = planned(&only(&["fig8"]));
    let finished = &mut plan.training_runs[0];
    finished.config.preset.budget = Budget::Episodes(1_000_000);
    finished.elsewhere = Some(FinishedRun::example(&finished.name));
    for shard in ["1/2", "2/2"] {
        let part = shard.parse::<Shard>().expect("a shard").of(&plan);
        let trained = part.training_runs.iter().filter(|training| training.elsewhere.is_none()).count();
        assert!((4..=5).contains(&trained), "{shard} trains {trained} of nine runs");
    }
}

#[test]
fn only_needed_episodes_and_seeds_are_planned() {
    let (_, plan) = planned(&only(&["table2"]));
    assert_eq!(
        budgets(&plan, 1),
        [("dqn".into(), Budget::Episodes(1000)), ("per_d3qn".into(), Budget::Episodes(1000))]
    );
    assert_eq!(plan.training_runs.len(), 10, "five seeds");
    assert_eq!(plan.training_runs[0].tests.len(), 1, "one test each");
    let (selected, _) = planned(&only(&["table7"]));
    let table = selected[0].tables.iter().map(|&i| &selected[0].source.experiment.tables[i].name);
    assert_eq!(table.collect::<Vec<_>>(), ["table6-7"], "a table is found by each of its aliases");
    let (_, plan) = planned(&ReproduceOptions { seeds: Some(Seeds::List(vec![3, 17])), ..only(&["fig8"]) });
    let seeds: Vec<u64> = plan.training_runs.iter().map(|training| training.config.seed).collect();
    assert_eq!(seeds, [3, 17, 3, 17], "two arms with the seeds of the list");
}

#[test]
fn arms_that_continue_together_share_a_marker() {
    let change = |(x, arm, scenario)| StageChange { x, scenario, arm };
    let changes =
        [(9.0, "a", "hall"), (9.0, "b", "hall"), (9.0, "c", "maze"), (9.0, "d", "hall"), (9.0, "a", "hall")];
    let labels: Vec<String> =
        merged_markers(&changes.map(change)).into_iter().map(|marker| marker.label).collect();
    assert_eq!(labels, ["a, b and d continue in hall", "c continues in maze"]);
}

#[test]
fn episodes_and_env_steps_are_counted_over_all_stages() {
    let at = |arm_run: &ArmRun, after: Budget, of_last_stage: bool| {
        arm_run.stage_at(TestPoint { after: Some(after), of_last_stage })
    };
    for unit in [Budget::Episodes, Budget::EnvSteps] {
        let arm_run = ArmRun { stages: vec![(0, unit(1000)), (1, unit(800))] };
        assert_eq!(at(&arm_run, unit(400), false), Some((0, unit(400))));
        assert_eq!(
            at(&arm_run, unit(1000), false),
            Some((0, unit(1000))),
            "the end of a stage belongs to it"
        );
        assert_eq!(at(&arm_run, unit(1001), false), Some((1, unit(1))));
        assert_eq!(at(&arm_run, unit(1800), false), Some((1, unit(800))));
        assert_eq!(at(&arm_run, unit(1801), false), None);
        assert_eq!(at(&arm_run, unit(800), true), Some((1, unit(800))));
        assert_eq!(at(&arm_run, unit(801), true), None);
        assert_eq!(arm_run.stage_at(TestPoint::overall(None)), Some((1, unit(800))), "the end");
    }
    let mixed = ArmRun { stages: vec![(0, Budget::EnvSteps(1000)), (1, Budget::Episodes(800))] };
    assert_eq!(at(&mixed, Budget::Episodes(5), false), None, "the first stage is not counted in episodes");
    assert_eq!(at(&mixed, Budget::Episodes(5), true), Some((1, Budget::Episodes(5))));
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
    tables: [(name: "t", title: "t", show: Seeds(measure: Success, after: Episodes(300)))],
)"#;

/// Writes the records of a run with the given goals per episode; every episode has 10 steps and a return of 100 per goal.
fn write_records(folder: &Path, training: &PlannedRun, goals: &[u32], results: &[PolicyTestResult]) {
    let folder =
        RunFolder::create(Some(folder.join(&training.name)), &training.config, None).expect("a folder");
    let mut episodes = folder.csv::<EpisodeRow>("episodes.csv", 0, &[]).expect("a file");
    let mut evaluations = folder.csv::<EvaluationRow>("evaluations.csv", 0, &[]).expect("a file");
    for i in 1..=2 {
        let success_rate = 0.25 * i as f64;
        let row =
            EvaluationRow { env_steps: 500 * i, episodes: 50 * i, success_rate, ..EvaluationRow::default() };
        evaluations.serialize(row).expect("a row");
    }
    evaluations.flush().expect("written");
    for (i, &goals) in (1..).zip(goals) {
        let total_return = 100.0 * f64::from(goals);
        let row = EpisodeRow { episode: i, env_steps: 10 * i, goals, total_return, ..EpisodeRow::default() };
        episodes.serialize(row).expect("a row");
    }
    episodes.flush().expect("written");
    policy_test::write_results(folder.path(), results).expect("written");
}

#[test]
fn measures_are_computed_from_the_records() {
    let folder = tempfile::tempdir().expect("a folder");
    let file: PathBuf = folder.path().join("two.ron");
    std::fs::write(&file, TWO_STAGES).expect("written");
    let (selected, plan) =
        planned(&ReproduceOptions { experiments: vec![file], ..ReproduceOptions::default() });
    assert_eq!(plan.training_runs.len(), 2);

    // No goals in the first stage. In the second, none in 100 episodes, then 4 in each of another 100.
    let second: Vec<u32> = (0..200).map(|i| if i < 100 { 0 } else { 4 }).collect();
    let result = PolicyTestResult {
        policy: policy_test::policy_file(PolicyId::After(Budget::Episodes(200))),
        rule: TestRule { rounds: 1, episodes: 4, seed: 5 },
        steps: vec![Some(50), None, Some(70), Some(60)],
        collisions: 1,
        benchmark_route_steps: vec![Some(60); policy_test::BENCHMARK_ROUTE_EPISODES],
    };
    write_records(folder.path(), &plan.training_runs[0], &[0; 100], &[]);
    write_records(folder.path(), &plan.training_runs[1], &second, &[result]);
    let optimal_times = OptimalTimesCache::new(folder.path().join("optimum"), ReportProgress::new(1));
    let results =
        Results::read(&plan, &selected, folder.path(), optimal_times).expect("the results are read");
    let arm = ArmIndex { experiment: 0, condition: 0, arm: 0 };
    let value_in = |measure, after, windows| {
        let point = TestPoint::overall(Some(Budget::Episodes(after)));
        let values = results.values(arm, measure, point, windows).expect("the value is known");
        assert_eq!(values.seeds, [1]);
        values.values[0]
    };
    let value = |measure, after| value_in(measure, after, Windows::default());
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
    for measure in [Measure::EpisodesTo(2.0), Measure::StepsTo(2.0)] {
        let MeasuredValue { value, is_lower_bound } = value(measure, 0);
        assert!(value.is_nan() && !is_lower_bound, "no value without episodes");
    }

    // A figure's own window of 20 episodes: 10 episodes with 4 goals make a mean of 2.
    assert_eq!(value_in(Measure::Return, 210, Windows::equal(20)), exactly(200.0), "10 of 20 episodes");
    assert_eq!(value_in(Measure::EpisodesTo(2.0), 300, Windows::equal(20)), exactly(110.0));

    let run = results.first_run(arm).expect("it has a run");
    let point = TestPoint::overall(Some(Budget::Episodes(300)));
    assert_eq!(results.rounds(arm, run, point).expect("the value is known"), [75.0], "one round");

    let curve = &results.curves(arm, Series::Goals, Axis::Episodes)[0];
    let (first, last) = (curve[99], curve[299]);
    assert_eq!((curve.len(), first, last), (300, (100.0, 0.0), (300.0, 4.0)), "the stages follow each other");
    let curve = &results.curves(arm, Series::Goals, Axis::EnvSteps)[0];
    assert_eq!((curve[99], curve[299]), ((1000.0, 0.0), (3000.0, 4.0)), "10 env steps per episode");
    let curve = &results.curves(arm, Series::SuccessRate, Axis::EnvSteps)[0];
    let expected = [(500.0, 25.0), (1000.0, 50.0), (1500.0, 25.0), (2000.0, 50.0)];
    assert_eq!(curve[..], expected, "two evaluations in each stage");
    // What the curve draws over episodes: 25 % after 50 episodes of a stage, 50 % after 100, and a line between them.
    let rates = [0, 50, 75, 100, 150, 180, 300].map(|after| value(Measure::SuccessRate, after).value);
    assert_eq!(rates, [25.0, 25.0, 37.5, 50.0, 25.0, 40.0, 50.0]);
    let point = TestPoint { after: Some(Budget::Episodes(0)), of_last_stage: true };
    let start = results.values(arm, Measure::SuccessRate, point, Windows::default()).expect("it is known");
    assert_eq!(start.values, [exactly(25.0)], "the first evaluation after the transfer");
}

#[test]
fn the_caption_of_a_map_names_the_rows_in_other_scenarios() {
    let folder = tempfile::tempdir().expect("a folder");
    let file: PathBuf = folder.path().join("two.ron");
    let text = TWO_STAGES.replace(
        "    tables: [",
        r#"    conditions: [
            (name: "plain"),
            (name: "noisy", overrides: {"scenario.lidar.noise_std_m": 0.02}),
            (name: "moving", scenario: "scenario-2"),
        ],
        figures: [(name: "f", title: "F", draw: BenchmarkRoute(after: Episodes(300)))],
        tables: ["#,
    );
    std::fs::write(&file, text).expect("written");
    let (selected, plan) =
        planned(&ReproduceOptions { experiments: vec![file], ..ReproduceOptions::default() });
    for training in &plan.training_runs {
        write_records(folder.path(), training, &[0; 200], &[]);
    }
    let optimal_times = OptimalTimesCache::new(folder.path().join("optimum"), ReportProgress::new(1));
    let results =
        Results::read(&plan, &selected, folder.path(), optimal_times).expect("the results are read");
    let caption = caption(&results, 0, &selected[0].source.experiment.figures[0]).expect("a caption");
    let expected = "F. The path of each arm is driven by the policy of its first seed (seed 1). Not drawn, because their \
                    walls, obstacles, robot, goal radius or route differ from those of the map: moving.";
    assert_eq!(caption, expected);
}

#[test]
fn overrides_and_conditions_change_the_fields_that_they_name_in_the_arms_that_they_name() {
    let folder = tempfile::tempdir().expect("a folder");
    let file: PathBuf = folder.path().join("two.ron");
    let text = TWO_STAGES
        .replace(
            "budget: Episodes(200))",
            r#"budget: Episodes(200), overrides: {
                "learning.gamma": 0.97, "reward.kind": Traditional, "scenario.task.max_episode_steps": 300,
                "learning.replay.sampling": Prioritized(alpha: 0.6, beta: Constant(0.4), importance_weights: true, epsilon: 0.01),
                "learning.replay.sampling.alpha": 0.7,
            })"#,
        )
        .replace(
            "    tables: [",
            r#"    conditions: [
                (name: "unchanged"),
                (name: "faster", scenario: "scenario-2", overrides: {"scenario.obstacles[*].motion.speed_rad_s": 0.3}),
                (name: "not in b", overrides: {"learning.gamma": 0.5}, only_arms: ["a"], only_scenarios: ["scenario-1"]),
            ],
            tables: ["#,
        )
        .replace("    arms: [", "    arms: [(name: \"b\", stages: [(scenario: \"empty\", preset: \"dqn\", budget: Episodes(300))]),");
    std::fs::write(&file, text).expect("written");
    let (_, plan) = planned(&ReproduceOptions { experiments: vec![file], ..ReproduceOptions::default() });
    let config = |condition: usize, arm: usize| {
        &plan.training_runs[plan.arm_runs[&(0, condition, arm, 1)].stages.last().expect("a stage").0].config
    };
    let (changed, faster) = (config(0, 1), config(1, 1));
    assert_eq!((changed.preset.learning.gamma, config(2, 1).preset.learning.gamma), (0.97, 0.5));
    assert_eq!(
        (changed.preset.reward.kind, changed.scenario.task.max_episode_steps),
        (RewardKind::Traditional, 300)
    );
    let Sampling::Prioritized { alpha, importance_weights, .. } = changed.preset.learning.replay.sampling
    else {
        panic!("not prioritized")
    };
    assert_eq!((alpha, importance_weights), (0.7, true), "in the order of the file");
    assert_eq!((faster.scenario.name.as_str(), faster.preset.learning.gamma), ("Scenario II", 0.97));
    let ron = crate::scenario::to_ron(&faster.scenario).expect("RON");
    assert_eq!(ron.matches("speed_rad_s: 0.3,").count(), 4, "all four cylinders: {ron}");
    assert_eq!(config(2, 0).preset, config(0, 0).preset, "the condition is only for the other arm");
}

#[test]
fn settings_from_the_command_line_change_all_training_runs() {
    let (_, plan) = planned(&only(&["fig8"]));
    let settings = ["learning.gamma=0.97", "scenario.lidar.noise_std_m=0.02"];
    let settings = Settings(settings.iter().map(|text| text.parse().expect("a setting")).collect());
    let (_, changed) = planned(&ReproduceOptions { settings, ..only(&["fig8"]) });
    assert_eq!(changed.training_runs.len(), plan.training_runs.len());
    for (training, before) in changed.training_runs.iter().zip(&plan.training_runs) {
        assert_eq!(training.config.preset.learning.gamma, 0.97);
        assert_eq!(training.config.scenario.lidar.noise_std_m, 0.02.into());
        assert_ne!(training.name, before.name, "a run without the settings is another run");
    }
}
