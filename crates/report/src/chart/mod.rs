//! Figures, in a common style.
//!
//! | figure | shows |
//! |---|---|
//! | [`CurveChart`] | values over episodes or steps, such as learning curves |
//! | [`DotPlot`] | single values by row and column, with their means |
//! | [`ScenarioMap`] | a scenario from above, with trajectories |
//!
//! In: plain numbers. Out: the text of an SVG file. Non-finite values are left out; a figure without values shows "no data
//! yet".

mod curve_chart;
#[cfg(not(target_arch = "wasm32"))]
mod dot_plot;
mod layout;
#[cfg(not(target_arch = "wasm32"))]
mod map;
#[cfg(test)]
pub(crate) mod svg_check;

pub(crate) use curve_chart::MAX_VERTICES;
pub use curve_chart::{BandPoint, ChartPanel, CurveChart, CurveLine, EventMarker, RawStyle, ReferenceLine};
#[cfg(not(target_arch = "wasm32"))]
pub use dot_plot::{DotCell, DotColumn, DotPlot};
#[cfg(not(target_arch = "wasm32"))]
pub use map::{
    MapObstacle, MapObstacleKind, MapRobot, MapShape, MapTrack, MapTrajectory, ScenarioMap, contact_sheet_svg,
};

#[cfg(test)]
mod tests {
    use super::svg_check::check;
    use super::*;
    use crate::statistics::Estimate;

    fn line(name: &str, colour: usize, episodes: u32) -> CurveLine {
        let height = |i: u32| f64::from(i * 7919 % 101) + f64::from(i) / 10.0 + colour as f64;
        let point =
            |i| BandPoint { x: f64::from(i), mean: height(i), low: height(i) - 40.0, high: height(i) + 40.0 };
        CurveLine {
            name: name.to_owned(),
            colour,
            points: (1..=episodes).map(point).collect(),
            raw: (1..=episodes).map(|i| (f64::from(i), height(i % 997 * 31))).collect(),
            raw_style: if colour.is_multiple_of(2) { RawStyle::Line } else { RawStyle::Dots },
            faint: colour == 2,
        }
    }

    fn curve_chart(lines: usize, panels: usize, episodes: u32) -> CurveChart {
        let panel = ChartPanel {
            heading: "Return per episode".to_owned(),
            y_unit: " %".to_owned(),
            lines: (0..lines).map(|i| line("Double DQN", i, episodes)).collect(),
            reference_lines: vec![ReferenceLine { value: 96.0, label: "paper: 96 %".to_owned() }],
            include_y: vec![0.0],
            limits: None,
        };
        CurveChart {
            title: "a < b & c".to_owned(),
            x_label: "episodes".to_owned(),
            include_x: vec![0.0],
            mean_label: "smoothed mean".to_owned(),
            band_label: "95 % interval".to_owned(),
            raw_label: "mean of each episode".to_owned(),
            panels: vec![panel; panels],
            markers: vec![EventMarker { x: 1000.0, label: "obstacles move from here".to_owned() }],
        }
    }

    #[test]
    fn curve_charts_stay_inside_the_figure_for_any_input() {
        let non_finite_band = |mean| BandPoint { x: 1.0, mean, low: f64::NAN, high: f64::INFINITY };
        let mut extreme = curve_chart(1, 1, 1);
        extreme.panels[0].lines[0].points = [f64::NAN, 1e300, -9e11, 9e11, 2.0].map(non_finite_band).to_vec();
        extreme.panels[0].lines[0].raw = vec![(f64::NAN, 1.0), (3.0, f64::INFINITY)];
        extreme.panels[0].reference_lines[0].value = f64::NAN;
        extreme.markers.push(EventMarker { x: f64::INFINITY, label: "never".to_owned() });
        let mut long = curve_chart(3, 1, 9);
        long.title = "a title that is far too long ".repeat(8);
        long.panels[0].lines[0].name = "a name that is far too long ".repeat(8);
        for (x, label) in [(2.0, "at 2"), (402.0, "later, with a label that is much too long to fit")] {
            long.markers.push(EventMarker { x, label: label.to_owned() });
        }
        let cases = [
            ("empty", CurveChart::default()),
            ("an empty panel", CurveChart { panels: vec![ChartPanel::default()], ..CurveChart::default() }),
            ("one episode", curve_chart(1, 1, 1)),
            ("four lines", curve_chart(4, 3, 1500)),
            ("extreme", extreme),
            ("long", long),
        ];
        for (name, figure) in cases {
            let svg = figure.svg().expect("the figure is drawn");
            check(name, &svg);
            assert_eq!(svg, figure.svg().expect("the figure is drawn"), "{name}");
        }
        assert!(CurveChart::default().svg().expect("the figure is drawn").contains("no data yet"));
        assert!(curve_chart(1, 1, 3).svg().expect("the figure is drawn").contains("a &lt; b &amp; c"));
    }

    #[test]
    fn labels_of_markers_at_the_same_place_can_all_be_read() {
        let labels = ["a continues in the hall", "b continues in the maze", "c continues in the field"];
        for x in [[700.0, 700.0, 700.0], [700.0, 702.0, 704.0], [1500.0, 1500.0, 1500.0]] {
            let marker = |(x, label): (f64, &str)| EventMarker { x, label: label.to_owned() };
            let markers = x.into_iter().zip(labels).map(marker).collect();
            let svg = CurveChart { markers, ..curve_chart(1, 2, 1500) }.svg().expect("the figure is drawn");
            check("markers at the same place", &svg);
            for label in labels {
                assert!(svg.lines().any(|line| line == label), "{label} at {x:?}");
            }
        }
    }

    #[test]
    fn wide_intervals_show_no_impossible_values_and_are_labelled_as_cut_off() {
        let wide = |mean: f64| BandPoint { x: mean, mean, low: mean - 40.0, high: mean + 40.0 };
        let band = |mean| BandPoint { mean: f64::NAN, ..wide(mean) };
        let with = |points: [BandPoint; 3], limits| {
            let line = CurveLine { points: points.to_vec(), ..CurveLine::default() };
            let panel = ChartPanel { lines: vec![line], limits, ..ChartPanel::default() };
            let chart =
                CurveChart { band_label: "interval".into(), panels: vec![panel], ..CurveChart::default() };
            chart.svg().expect("the figure is drawn")
        };
        let svg = |limits| with([0.0, 1.0, 2.0].map(wide), limits);
        let negative = |svg: &str| svg.lines().any(|line| line.trim_start().starts_with('\u{2212}'));
        assert!(negative(&svg(None)) && !negative(&svg(Some((0.0, f64::INFINITY)))));
        assert!(svg(None).contains("interval, cut off at the frame"));
        assert!(svg(Some((0.0, 2.5))).contains("interval\n"), "an interval that ends at a limit is whole");
        assert!(
            with([0.0, 1.0, 2.0].map(band), None).contains("interval\n"),
            "without means, they are whole"
        );
        for limits in [None, Some((0.0, f64::INFINITY)), Some((0.0, 2.5))] {
            check("wide intervals", &svg(limits));
        }
    }

    #[test]
    fn many_long_curves_still_give_a_small_file() {
        let mut chart = curve_chart(6, 3, 20_000);
        chart.panels.iter_mut().flat_map(|p| &mut p.lines).for_each(|l| l.raw_style = RawStyle::Line);
        let svg = chart.svg().expect("the figure is drawn");
        assert!(svg.len() < 400_000, "{} bytes", svg.len());
    }

    #[test]
    fn dot_plots_stay_inside_the_figure_for_any_input() {
        let cell = |values: &[f64]| DotCell {
            values: values.to_vec(),
            estimate: Estimate::from_values(values),
            paper: Some(96.0),
            censored: true,
        };
        let column = |cells: &[DotCell]| DotColumn {
            heading: "Mean time to the goal".to_owned(),
            unit: "thousand env steps".to_owned(),
            limits: Some((0.0, 1e6)),
            cells: cells.to_vec(),
        };
        let figure = |columns: &[DotColumn]| DotPlot {
            title: "a < b & c".to_owned(),
            rows: ["PER-D3QN", "", "a name that is far too long and on and on"].map(str::to_owned).to_vec(),
            columns: columns.to_vec(),
        };
        let plain = column(&[cell(&[90.0, 95.0, 99.0]), DotCell::default(), cell(&[1.0])]);
        let wide = column(&[cell(&[0.0, 1_234_567.0]), cell(&[f64::NAN, 9e11])]);
        let cases = [
            ("empty", DotPlot::default()),
            ("no column", figure(&[])),
            ("an empty column", figure(&[column(&[])])),
            ("plain", figure(&[plain.clone(), plain.clone()])),
            ("wide", figure(&[wide, plain.clone(), plain.clone()])),
            ("twenty columns", figure(&vec![plain; 20])),
        ];
        for (name, figure) in cases {
            let svg = figure.svg().expect("the figure is drawn");
            check(name, &svg);
            assert_eq!(svg, figure.svg().expect("the figure is drawn"), "{name}");
        }
        assert!(figure(&[column(&[])]).svg().expect("the figure is drawn").contains("no data yet"));
        assert!(figure(&[]).svg().expect("the figure is drawn").contains("a &lt; b &amp; c"));
    }

    #[test]
    fn scenario_maps_stay_inside_the_figure_for_any_input() {
        let obstacle = |kind, outline| MapObstacle { kind, outline };
        let disc = |x, y, radius| obstacle(MapObstacleKind::Moving(0.3), MapShape::Disc(x, y, radius));
        let beyond_the_enclosure = vec![(1.0, 1.0), (9.0, 1.0), (9.0, 2.0), (1.0, 2.0)];
        let map = ScenarioMap {
            title: "a < b & c".to_owned(),
            enclosure: vec![(-2.5, -2.5), (2.5, -2.5), (2.5, 2.5), (-2.5, 2.5)],
            marked_areas: vec![beyond_the_enclosure.clone(), vec![(f64::NAN, 0.0), (1e300, 0.0), (0.0, 1.0)]],
            obstacles: vec![
                disc(0.0, 0.0, 0.5),
                disc(2.4, 2.4, 1.0),
                disc(f64::NAN, 0.0, 1.0),
                disc(0.0, 0.0, 1e300),
                obstacle(MapObstacleKind::Wall, MapShape::Polygon(beyond_the_enclosure.clone())),
                obstacle(MapObstacleKind::Generated, MapShape::Polygon(Vec::new())),
                obstacle(MapObstacleKind::Moving(f64::NAN), MapShape::Polygon(beyond_the_enclosure.clone())),
            ],
            tracks: vec![
                MapTrack::Lines(beyond_the_enclosure),
                MapTrack::Lines(vec![(f64::NAN, 0.0), (0.0, 0.0), (0.0, 0.0)]),
                MapTrack::Ring(2.0, 0.0, 1.0),
                MapTrack::Ring(0.0, 0.0, f64::NAN),
            ],
            start: Some((-2.0, -2.0, 0.8)),
            goal: Some((2.0, 2.0, 0.3)),
            trajectories: vec![MapTrajectory {
                name: "PER-D3QN".to_owned(),
                colour: 0,
                points: vec![(-2.0, -2.0), (f64::NAN, 0.0), (70.0, 0.0), (2.0, 2.0)],
            }],
        };
        let with_enclosure = |x: f64, y: f64| {
            let corners = [(-x, -y), (x, -y), (x, y), (0.0, 0.0), (-x, y)];
            ScenarioMap { enclosure: corners.to_vec(), ..map.clone() }
        };
        let cases = [
            ("empty", ScenarioMap::default()),
            ("not finite", with_enclosure(f64::INFINITY, 2.5)),
            ("flat", with_enclosure(2.5, 0.0)),
            ("square", map.clone()),
            ("wide", with_enclosure(20.0, 2.5)),
            ("tall", with_enclosure(2.5, 20.0)),
            (
                "no start and no goal",
                ScenarioMap {
                    start: Some((f64::NAN, 0.0, 0.0)),
                    goal: Some((0.0, f64::NAN, 1.0)),
                    ..map.clone()
                },
            ),
        ];
        for (name, figure) in cases {
            for draw in [ScenarioMap::svg, ScenarioMap::thumbnail_svg] {
                let svg = draw(&figure).expect("the figure is drawn");
                check(name, &svg);
                assert_eq!(svg, draw(&figure).expect("the figure is drawn"), "{name}");
            }
        }
        for count in [0, 1, 6] {
            check(
                "contact sheet",
                &contact_sheet_svg("a < b & c", &vec![map.clone(); count]).expect("it is drawn"),
            );
        }
        let small = map.thumbnail_svg().expect("the figure is drawn");
        assert!(small.contains(r#"width="480" height="360""#) && !small.contains("<text"));
        assert!(ScenarioMap::default().svg().expect("the figure is drawn").contains("no data yet"));
        assert!(map.svg().expect("the figure is drawn").contains("a &lt; b &amp; c"));
    }
}
