//! The figures of a comparison, one look for all of them.
//!
//! In: plain numbers, already averaged: [`LearningCurves`] over episodes, [`DotPlot`] for single values by row, [`ScenarioMap`] for
//! a world and the ways through it. Out: each as the text of an SVG file. A value that is no finite number is left
//! out, and a figure without any says "nothing yet". No figure needs colour to be read.

use plotters::style::text_anchor::HPos;

use super::style::{Area, DrawResult, SOFT_INK, TEXT, write};

mod dot_plot;
mod learning_curves;
mod map;

pub use dot_plot::{DotCell, DotColumn, DotPlot};
pub use learning_curves::{BandPoint, ChartPanel, CurveLine, EventMarker, LearningCurves, ReferenceLine};
pub use map::{MapObstacle, MapObstacleKind, MapTrajectory, ScenarioMap, Silhouette, Track};

// Sizes in drawn pixels. A figure is narrow enough for its type to be legible 12 cm wide on paper.
const WIDTH: i32 = 1280;
const LEFT: i32 = 128;

/// Says that there is nothing to be shown, between two lines of the grid.
fn draw_nothing(root: &Area, (left, right): (i32, i32), (upper, lower): (i32, i32)) -> DrawResult {
    let middle = ((left + right) / 2, (upper + lower) / 2);
    write(root, "nothing yet", middle, TEXT, &SOFT_INK, HPos::Center)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::Estimate;
    use crate::style::text_width;

    /// The value of an attribute in a line of SVG, as a number.
    fn attribute(line: &str, name: &str) -> Option<f64> {
        line.split_once(&format!(" {name}=\""))?.1.split_once('"')?.0.parse().ok()
    }

    /// Left, right, top and bottom of each text, and the text.
    fn texts(svg: &str) -> Vec<([f64; 4], String)> {
        let lines: Vec<&str> = svg.lines().collect();
        let found = lines.windows(2).filter(|pair| pair[0].starts_with("<text")).map(|pair| {
            let number = |name| attribute(pair[0], name).expect("texts have a place");
            let (x, y, size) = (number("x"), number("y"), number("font-size"));
            let width = f64::from(text_width(pair[1], size * 1.24));
            let left = match pair[0] {
                line if line.contains("\"end\"") => x - width,
                line if line.contains("\"middle\"") => x - width / 2.0,
                _ => x,
            };
            ([left, left + width, y - size / 2.0, y + size / 2.0], pair[1].to_owned())
        });
        found.collect()
    }

    /// Nothing leaves the picture, no text lies on another, and no number is none.
    fn check(name: &str, svg: &str) {
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"), "{name}");
        assert!(!svg.contains("NaN") && !svg.contains("inf\""), "{name}");
        let (_, view) = svg.split_once("viewBox=\"0 0 ").expect("a picture has a size");
        let size: Vec<f64> =
            view.split(['"', ' ']).take(2).map(|n| n.parse().expect("a size is a number")).collect();
        let inside = |x: f64, y: f64| (0.0..=size[0]).contains(&x) && (0.0..=size[1]).contains(&y);
        for line in svg.lines() {
            if let (Some(x), Some(y)) = (attribute(line, "cx"), attribute(line, "cy")) {
                let r = attribute(line, "r").unwrap_or(0.0);
                assert!(inside(x - r, y - r) && inside(x + r, y + r), "{name}: {line}");
            }
            let points = line.split_once(" points=\"").map_or("", |(_, rest)| rest.trim_end_matches("\"/>"));
            for pair in points.split_whitespace() {
                let (x, y) = pair.split_once(',').expect("a pair");
                let place = (x.parse().expect("a number"), y.parse().expect("a number"));
                assert!(inside(place.0, place.1), "{name}: {place:?}");
            }
        }
        let texts = texts(svg);
        for (i, ([left, right, top, bottom], text)) in texts.iter().enumerate() {
            assert!(inside(*left, *top) && inside(*right, *bottom), "{name}: {text} leaves the picture");
            for ([l, r, t, b], other) in &texts[..i] {
                let apart = right <= l || r <= left || bottom <= t || b <= top;
                assert!(apart, "{name}: {text} lies on {other}");
            }
        }
    }

    fn line(name: &str, colour: usize, episodes: u32) -> CurveLine {
        let height = |i: u32| f64::from(i * 7919 % 101) + f64::from(i) / 10.0 + colour as f64;
        let point =
            |i| BandPoint { x: f64::from(i), mean: height(i), low: height(i) - 40.0, high: height(i) + 40.0 };
        CurveLine {
            name: name.to_owned(),
            colour,
            points: (1..=episodes).map(point).collect(),
            raw: (1..=episodes).map(|i| (f64::from(i), height(i % 997 * 31))).collect(),
        }
    }

    fn curves(lines: usize, panels: usize, episodes: u32) -> LearningCurves {
        let panel = ChartPanel {
            heading: "Return per episode".to_owned(),
            y_unit: " %".to_owned(),
            lines: (0..lines).map(|i| line("Double DQN", i, episodes)).collect(),
            reference_lines: vec![ReferenceLine { value: 96.0, label: "paper: 96 %".to_owned() }],
            include_y: Some(0.0),
        };
        LearningCurves {
            title: "a < b & c".to_owned(),
            x_label: "episodes".to_owned(),
            panels: vec![panel; panels],
            marks: vec![EventMarker { x: 1000.0, label: "moving obstacles from here".to_owned() }],
        }
    }

    #[test]
    fn curves_stay_in_the_picture_whatever_they_show() {
        let odd = |mean| BandPoint { x: 1.0, mean, low: f64::NAN, high: f64::INFINITY };
        let mut strange = curves(1, 1, 1);
        strange.panels[0].lines[0].points = vec![odd(f64::NAN), odd(1e300), odd(-9e11), odd(9e11), odd(2.0)];
        strange.panels[0].lines[0].raw = vec![(f64::NAN, 1.0), (3.0, f64::INFINITY)];
        strange.panels[0].reference_lines[0].value = f64::NAN;
        strange.marks.push(EventMarker { x: f64::INFINITY, label: "never".to_owned() });
        let mut long = curves(3, 1, 9);
        long.title = "a title that goes on and on ".repeat(8);
        long.panels[0].lines[0].name = "a name that goes on and on ".repeat(8);
        for mark in ["at 2", "soon after, in very many words that do not fit"] {
            long.marks
                .push(EventMarker { x: 2.0 + 400.0 * (mark.len() > 9) as u8 as f64, label: mark.to_owned() });
        }
        let cases = [
            ("none", LearningCurves::default()),
            (
                "an empty panel",
                LearningCurves { panels: vec![ChartPanel::default()], ..LearningCurves::default() },
            ),
            ("one episode", curves(1, 1, 1)),
            ("four lines", curves(4, 3, 1500)),
            ("strange", strange),
            ("long", long),
        ];
        for (name, figure) in cases {
            let svg = figure.svg().expect("is drawn");
            check(name, &svg);
            assert_eq!(svg, figure.svg().expect("is drawn"), "{name}");
        }
        assert!(LearningCurves::default().svg().expect("is drawn").contains("nothing yet"));
        assert!(curves(1, 1, 3).svg().expect("is drawn").contains("a &lt; b &amp; c"));
    }

    #[test]
    fn many_curves_are_a_small_file() {
        let svg = curves(6, 3, 20_000).svg().expect("is drawn");
        assert!(svg.len() < 400_000, "{} bytes", svg.len());
    }

    #[test]
    fn dots_stay_in_the_picture_whatever_they_show() {
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
            rows: ["PER-D3QN", "", "a name that goes on and on and on and on"].map(str::to_owned).to_vec(),
            columns: columns.to_vec(),
        };
        let plain = column(&[cell(&[90.0, 95.0, 99.0]), DotCell::default(), cell(&[1.0])]);
        let wide = column(&[cell(&[0.0, 1_234_567.0]), cell(&[f64::NAN, 9e11])]);
        let cases = [
            ("none", DotPlot::default()),
            ("no column", figure(&[])),
            ("empty", figure(&[column(&[])])),
            ("plain", figure(&[plain.clone(), plain.clone()])),
            ("wide", figure(&[wide, plain.clone(), plain])),
        ];
        for (name, figure) in cases {
            let svg = figure.svg().expect("is drawn");
            check(name, &svg);
            assert_eq!(svg, figure.svg().expect("is drawn"), "{name}");
        }
        assert!(figure(&[column(&[])]).svg().expect("is drawn").contains("nothing yet"));
        assert!(figure(&[]).svg().expect("is drawn").contains("a &lt; b &amp; c"));
    }

    #[test]
    fn maps_stay_in_the_picture_whatever_they_show() {
        let solid = |kind, outline| MapObstacle { kind, outline };
        let disc = |x, y, radius| solid(MapObstacleKind::Moving(0.3), Silhouette::Disc(x, y, radius));
        let beyond = vec![(1.0, 1.0), (9.0, 1.0), (9.0, 2.0), (1.0, 2.0)];
        let map = ScenarioMap {
            title: "a < b & c".to_owned(),
            enclosure: vec![(-2.5, -2.5), (2.5, -2.5), (2.5, 2.5), (-2.5, 2.5)],
            obstacles: vec![
                disc(0.0, 0.0, 0.5),
                disc(2.4, 2.4, 1.0),
                disc(f64::NAN, 0.0, 1.0),
                disc(0.0, 0.0, 1e300),
                solid(MapObstacleKind::Wall, Silhouette::Polygon(beyond.clone())),
                solid(MapObstacleKind::Generated, Silhouette::Polygon(Vec::new())),
                solid(MapObstacleKind::Moving(f64::NAN), Silhouette::Polygon(beyond.clone())),
            ],
            tracks: vec![
                Track::Lines(beyond),
                Track::Lines(vec![(f64::NAN, 0.0), (0.0, 0.0), (0.0, 0.0)]),
                Track::Ring(2.0, 0.0, 1.0),
                Track::Ring(0.0, 0.0, f64::NAN),
            ],
            start: (-2.0, -2.0, 0.8),
            goal: (2.0, 2.0, 0.3),
            trajectories: vec![MapTrajectory {
                name: "PER-D3QN".to_owned(),
                colour: 0,
                points: vec![(-2.0, -2.0), (f64::NAN, 0.0), (70.0, 0.0), (2.0, 2.0)],
            }],
        };
        let within = |x: f64, y: f64| {
            let corners = [(-x, -y), (x, -y), (x, y), (0.0, 0.0), (-x, y)];
            ScenarioMap { enclosure: corners.to_vec(), ..map.clone() }
        };
        let cases = [
            ("none", ScenarioMap::default()),
            ("not finite", within(f64::INFINITY, 2.5)),
            ("flat", within(2.5, 0.0)),
            ("square", map.clone()),
            ("wide", within(20.0, 2.5)),
            ("tall", within(2.5, 20.0)),
            (
                "nowhere",
                ScenarioMap { start: (f64::NAN, 0.0, 0.0), goal: (0.0, f64::NAN, 1.0), ..map.clone() },
            ),
        ];
        for (name, figure) in cases {
            for draw in [ScenarioMap::svg, ScenarioMap::thumbnail_svg] {
                let svg = draw(&figure).expect("is drawn");
                check(name, &svg);
                assert_eq!(svg, draw(&figure).expect("is drawn"), "{name}");
            }
        }
        let small = map.thumbnail_svg().expect("is drawn");
        assert!(small.contains(r#"width="480" height="360""#) && !small.contains("<text"));
        assert!(ScenarioMap::default().svg().expect("is drawn").contains("nothing yet"));
        assert!(map.svg().expect("is drawn").contains("a &lt; b &amp; c"));
    }
}
