//! Tests of the history: downsampling against brute force, memory bounds, exported files.

use std::io::ErrorKind;

use super::*;
use crate::report::run_figure::EpisodePoint;

/// Pseudo-random numbers from -1 to 1, the same each time.
fn noise(count: usize) -> impl Iterator<Item = f64> {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    std::iter::repeat_with(move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / f64::from(1 << 23) - 1.0
    })
    .take(count)
}

fn row(episode: u64, goals: u32) -> EpisodeRow {
    EpisodeRow {
        episode,
        env_steps: episode * 10,
        goals,
        total_return: 0.1 * episode as f64,
        ..Default::default()
    }
}

/// Compares the series of `values` at x = 0, 3, 6, ... with a brute-force computation.
fn assert_series_of(values: &[f64]) {
    let mut series = DownsampledSeries::default();
    for (index, &value) in values.iter().enumerate() {
        series.push(3.0 * index as f64, value);
    }
    let mut stride = 1;
    while values.len() > stride * MAX_POINTS {
        stride *= 2;
    }
    let (points, lows, highs) = (series.points(), series.lows(), series.highs());
    assert!(points.len() <= MAX_POINTS && points.len() == values.len().div_ceil(stride), "{}", points.len());
    assert_eq!((lows.len(), highs.len()), (points.len(), points.len()));
    for (index, bucket) in values.chunks(stride).enumerate() {
        let mean = bucket.iter().sum::<f64>() / bucket.len() as f64;
        let middle = 3.0 * (index * stride) as f64 + 1.5 * (bucket.len() - 1) as f64;
        assert!((points[index].y - mean).abs() < 1e-9, "mean value of bucket {index}");
        assert!((points[index].x - middle).abs() <= 1e-9 * middle, "mean x of bucket {index}");
        assert_eq!(lows[index], bucket.iter().copied().fold(f64::INFINITY, f64::min));
        assert_eq!(highs[index], bucket.iter().copied().fold(f64::NEG_INFINITY, f64::max));
    }
    assert!(points.is_sorted_by(|a, b| a.x < b.x), "x is in order");
    assert_eq!(series.latest().map(|latest| latest.y), values.last().copied());
}

#[test]
fn a_series_of_any_length_agrees_with_brute_force() {
    let values: Vec<f64> = noise(20_011).collect();
    for length in [0, 1, 2, 999, 1000, 1001, 1002, 1999, 2000, 2001, 3999, 4001, 16_000, 16_001, 20_011] {
        assert_series_of(&values[..length]);
    }
}

#[test]
fn a_million_rows_take_at_most_the_maximum_number_of_points() {
    assert_series_of(&noise(1_000_003).collect::<Vec<_>>());
}

#[test]
fn non_finite_values_are_ignored_and_x_never_decreases() {
    let mut series = DownsampledSeries::default();
    for (x, value) in
        [(5.0, 1.0), (f64::NAN, 1.0), (6.0, f64::INFINITY), (3.0, 2.0), (7.0, f64::NAN), (9.0, 4.0)]
    {
        series.push(x, value);
    }
    let points: Vec<_> = series.points().iter().map(|point| (point.x, point.y)).collect();
    assert_eq!(points, [(5.0, 1.0), (5.0, 2.0), (9.0, 4.0)]);
    let near = [-1.0, 8.0, 99.0].map(|x| series.value_near(x));
    assert_eq!(near, [Some(1.0), Some(4.0), Some(4.0)]);
    assert_eq!(DownsampledSeries::default().value_near(0.0), None);
}

#[test]
fn a_moving_average_covers_the_last_hundred_rows() {
    let values: Vec<f64> = noise(777).collect();
    let mut trailing = MovingAverage::default();
    for (index, &value) in values.iter().enumerate() {
        trailing.push(index as f64, value);
        let window = &values[index.saturating_sub(MOVING_AVERAGE_EPISODES - 1)..=index];
        let mean = window.iter().sum::<f64>() / window.len() as f64;
        assert!((trailing.series().latest().expect("a point").y - mean).abs() < 1e-12);
    }
}

#[test]
fn the_success_rate_counts_goals_attempted_not_episodes() {
    let mut history = History::new();
    for (episode, goals) in [(1, 0), (2, 3), (3, 1)] {
        history.push_episode(&row(episode, goals));
    }
    let rate = history.curves().success.series().latest().expect("a point").y;
    assert!((rate - 4.0 / 7.0).abs() < 1e-12, "4 of 7 goals attempted: {rate}");
    for episode in 4..=103 {
        history.push_episode(&row(episode, 9));
    }
    let rate = history.curves().success.series().latest().expect("a point").y;
    assert!((rate - 0.9).abs() < 1e-12, "the first three episodes have left the window: {rate}");
}

#[test]
fn the_axis_starts_at_0_or_at_the_first_row_of_a_resumed_run() {
    let mut history = History::new();
    assert_eq!(history.range(), None);
    history.push_episode(&row(1, 0));
    history.push_episode(&row(7, 0));
    assert_eq!(history.range(), Some((0, 70)));
    history = History::new();
    history.push_episode(&row(500, 0));
    history.push_evaluation(&EvaluationRow { env_steps: 6000, episodes: 600, ..Default::default() });
    assert_eq!(history.range(), Some((5000, 6000)));
}

#[test]
fn the_curves_before_a_transfer_stay_in_the_background() {
    let mut history = History::new();
    for episode in 1..=300 {
        history.push_episode(&row(episode, 2));
    }
    history.push_evaluation(&EvaluationRow { env_steps: 3000, success_rate: 0.5, ..Default::default() });
    let (earlier, curves) = (history.to_earlier(), history.curves().clone());
    history = History::new();
    assert!(history.earlier().is_none());
    history.set_earlier(earlier);
    assert_eq!(history.range(), Some((0, 3000)), "the axis shows all of them at once");
    history.push_episode(&row(1, 0));
    assert_eq!(history.range(), Some((0, 3000)));
    let shown = history.earlier().expect("set before");
    assert_eq!((&shown.evaluated, &shown.return_mean), (&curves.evaluated, curves.return_mean.series()));
    let figure = history.figure("A run".into(), None, false);
    assert_eq!(
        (figure.earlier.success_rate.as_slice(), figure.earlier.goal_mean.len()),
        (&[(3000.0, 0.5)][..], 300)
    );
}

#[test]
fn a_text_repeated_soon_extends_the_last_annotation() {
    let mut history = History::new();
    for step in 1000..1040 {
        history.annotate(step, "goal moved".into());
    }
    history.annotate(1040, "transfer to Scenario II".into());
    history.annotate(1041, "goal moved".into());
    history.annotate(2000, "goal moved".into());
    let marks: Vec<_> =
        history.annotations().iter().map(|mark| (mark.env_steps, mark.last_env_steps)).collect();
    assert_eq!(marks, [(1000, 1039), (1040, 1040), (1041, 1041), (2000, 2000)]);
    for step in 0..10_000_u64 {
        history.annotate(step * step, format!("mark {step}"));
    }
    assert!(history.annotations().len() <= 60);
    assert!(history.annotations().is_sorted_by_key(|mark| mark.env_steps));
}

#[test]
fn the_csv_equals_that_of_a_headless_run() {
    let folder = tempfile::tempdir().expect("creates a folder");
    let (exported, expected) = (folder.path().join("ours.csv"), folder.path().join("theirs.csv"));
    let mut history = History::new();
    history.write_csv(&exported).expect("writes the file");
    let header = std::fs::read_to_string(&exported).expect("reads the file");
    assert!(header.starts_with("episode,arena,env_steps,") && header.lines().count() == 1, "{header}");

    let mut writer = csv::Writer::from_path(&expected).expect("opens the file");
    for episode in 1..=5000 {
        let row = EpisodeRow { loss: (episode > 9).then_some(1e-7 / episode as f64), ..row(episode, 2) };
        writer.serialize(&row).expect("writes the file");
        history.push_episode(&row);
        if episode % 1234 == 0 {
            history.write_csv(&exported).expect("writes the CSV between episodes");
        }
    }
    writer.flush().expect("writes the file");
    history.write_csv(&exported).expect("writes the file");
    assert_eq!(
        std::fs::read(&exported).expect("reads the file"),
        std::fs::read(&expected).expect("reads the file")
    );
    history = History::new();
    history.write_csv(&exported).expect("writes the file");
    assert_eq!(std::fs::read_to_string(&exported).expect("reads the file"), header);
}

#[test]
fn the_figure_is_drawn_with_and_without_rows() {
    let folder = tempfile::tempdir().expect("creates a folder");
    let path = folder.path().join("curve.png");
    let mut history = History::new();
    let empty = history.figure("Nothing yet".into(), None, false);
    write_figure(&empty, &path).expect("draws the PNG");
    for episode in 1..=3000 {
        history.push_episode(&row(episode, 1));
    }
    history.push_evaluation(&EvaluationRow { env_steps: 30_000, success_rate: 0.5, ..Default::default() });
    history.annotate(20_000, "scenario changed".into());
    let figure = history.figure("A run".into(), None, true);
    assert_eq!((figure.episodes.len(), figure.evaluations.len(), figure.marks.len()), (3000, 1, 1));
    assert_eq!(
        figure.episodes[2999],
        EpisodePoint { env_steps: 30_000, total_return: 0.1 * 3000.0, goals: 1 }
    );
    write_figure(&figure, &path).expect("draws the PNG");
    let png = std::fs::read(&path).expect("reads the file");
    assert!(png.starts_with(b"\x89PNG"));
    assert_eq!(png[16..20], 2560_u32.to_be_bytes(), "wide enough for print");
    let svg = path.with_extension("svg");
    write_figure(&figure, &svg).expect("draws the SVG");
    let text = std::fs::read_to_string(&svg).expect("reads the file");
    assert!(text.starts_with("<svg") && text.contains("scenario changed") && text.contains("paper 96%"));
    let error = write_figure(&figure, &folder.path().join("curve.jpg")).expect_err("not a format");
    assert!(error.to_string().ends_with("give a file name that ends in .svg, .png or .pdf"), "{error}");
    let nowhere = folder.path().join("no/such/folder.png");
    assert!(write_figure(&figure, &nowhere).is_err());
    assert_eq!(
        history.write_csv(&nowhere).expect_err("the folder does not exist").kind(),
        ErrorKind::NotFound
    );
}

#[test]
fn a_history_is_send_and_sync() {
    fn assert_send_sync<T: Send + Sync + 'static>() {}
    assert_send_sync::<History>();
}
