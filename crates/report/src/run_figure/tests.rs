//! Tests of the figure of a run.

use super::*;

fn episodes(n: u64) -> Vec<EpisodePoint> {
    let one = |i| EpisodePoint {
        env_steps: i * 37,
        total_return: (i * 7919 % 101) as f64 - 60.0,
        goals: (i % 13) as u32,
    };
    (1..=n).map(one).collect()
}

fn evaluation(env_steps: u64, success_rate: f64) -> EvaluationPoint {
    EvaluationPoint {
        env_steps,
        success_rate,
        mean_time_s: Some(5.04),
        mean_cost_s: 100.0 - 95.0 * success_rate,
    }
}

fn figure(episodes: &[EpisodePoint], evaluations: &[EvaluationPoint]) -> RunFigure {
    RunFigure {
        title: "A run".into(),
        episodes: episodes.into(),
        evaluations: evaluations.into(),
        best: best_evaluation(evaluations, 1.01),
        ..RunFigure::default()
    }
}

fn svg(episodes: &[EpisodePoint], evaluations: &[EvaluationPoint]) -> String {
    figure(episodes, evaluations).svg().expect("the figure is drawn")
}

#[test]
fn in_the_figure_of_any_run_nothing_is_outside_and_no_texts_overlap() {
    let odd = |total_return| EpisodePoint { env_steps: 500, total_return, goals: 1 };
    let cases: [(&str, Vec<EpisodePoint>, Vec<EvaluationPoint>); 6] = [
        ("empty", vec![], vec![]),
        ("one of each", episodes(1), vec![evaluation(37, 0.5)]),
        ("all at step 0", vec![EpisodePoint { env_steps: 0, total_return: 0.0, goals: 0 }], vec![]),
        ("constant", vec![odd(-7.5); 80], vec![evaluation(10, 1.0), evaluation(20, 1.0)]),
        ("not finite", vec![odd(f64::NAN), odd(f64::INFINITY), odd(1e300)], vec![evaluation(1, f64::NAN)]),
        ("huge values", vec![odd(9e11), odd(-9e11)], vec![evaluation(u64::MAX, 7.0)]),
    ];
    for (name, episodes, evaluations) in cases {
        crate::chart::svg_check::check(name, &svg(&episodes, &evaluations));
    }
    assert!(svg(&[], &[]).contains("no data yet"));
}

#[test]
fn a_long_run_gives_a_small_file_whatever_the_order_of_its_points() {
    let evaluations: Vec<_> = (1..5000).map(|i| evaluation(i * 740, 0.9)).collect();
    let mut many = episodes(100_000);
    let one = svg(&many, &evaluations);
    assert!(one.len() < 300_000, "{} bytes", one.len());
    many.reverse();
    assert_eq!(one, svg(&many, &evaluations), "the order of the points does not matter");
}

#[test]
fn the_best_evaluation_is_marked() {
    let evaluations = [evaluation(1000, 0.5), evaluation(12_000, 0.9999), evaluation(13_000, 0.9999)];
    let best = best_evaluation(&evaluations, 1.01).expect("one is the best");
    let marker = best_marker(&best);
    assert_eq!((marker.x, marker.label.as_str()), (13.0, "best: 99.9% at 13,000 steps, 5.0 s per goal"));
    assert!(svg(&[], &evaluations).contains("best: 99.9%"));
    assert_eq!(best_evaluation(&[], 1.01), None);
}

#[test]
fn the_figure_shows_the_latest_values_and_the_paper_only_where_it_applies() {
    let (episodes, evaluations) = (episodes(130), [evaluation(1000, 0.5), evaluation(2000, 0.875)]);
    let mean = (31..=130).map(|i| f64::from(i % 13)).sum::<f64>() / 100.0;
    let goals = number(mean, 1);
    let training = format!("in training {}", percent(mean / (mean + 1.0)));
    let elsewhere = svg(&episodes, &evaluations);
    for text in ["greedy 87.5%", &training, "mean of 100 episodes", "one evaluation or episode", &goals] {
        assert!(elsewhere.contains(text), "{text} is missing");
    }
    let here = RunFigure { is_paper_scenario_1: true, ..figure(&episodes, &evaluations) }.svg();
    let here = here.expect("the figure is drawn");
    for text in ["paper 96%", "paper 2,500"] {
        assert!(here.contains(text) && !elsewhere.contains(text), "{text}");
    }
}

#[test]
fn marks_and_the_curves_before_a_transfer_are_shown() {
    let curve: Vec<_> = (0..500).map(|i| (f64::from(i) * 400.0, f64::from(i) / 500.0)).collect();
    let earlier = EarlierRun { success_rate: curve.clone(), return_mean: curve.clone(), goal_mean: curve };
    let marks = vec![RunMark { env_steps: 3000, text: "scenario changed".into() }];
    let plain = figure(&episodes(130), &[]);
    let svg = RunFigure { earlier, marks, ..plain.clone() }.svg().expect("the figure is drawn");
    crate::chart::svg_check::check("transfer", &svg);
    assert!(svg.contains("scenario changed") && svg.matches("before transfer").count() == 3);
    let reaches_150k = |svg: &str| svg.lines().any(|line| line.trim() == "150");
    assert!(reaches_150k(&svg), "the axis reaches to the end of the earlier curves, 200k steps");
    assert!(!reaches_150k(&plain.svg().expect("the figure is drawn")));
}

#[test]
fn many_episodes_are_drawn_as_a_band() {
    let svg = |n| figure(&episodes(n), &[]).svg().expect("the figure is drawn");
    let band = "lowest to highest episode";
    assert!(!svg(1000).contains(band) && svg(1000).contains("one evaluation or episode"));
    assert!(svg(1001).contains(band) && !svg(1001).contains("one evaluation or episode"));
}

#[test]
fn markup_in_the_title_is_escaped() {
    let svg =
        RunFigure { title: "a < b & c".into(), ..RunFigure::default() }.svg().expect("the figure is drawn");
    assert!(svg.contains("a &lt; b &amp; c"));
}
