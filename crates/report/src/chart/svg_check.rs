//! The checks that tests run on drawn SVGs.

use crate::style::text_width;

/// The value of an attribute in a line of SVG, as a number.
fn attribute(line: &str, name: &str) -> Option<f64> {
    line.split_once(&format!(" {name}=\""))?.1.split_once('"')?.0.parse().ok()
}

/// The left, right, top and bottom edge of each text, with the text.
fn texts(svg: &str) -> Vec<([f64; 4], String)> {
    let lines: Vec<&str> = svg.lines().collect();
    let found = lines.windows(2).filter(|pair| pair[0].starts_with("<text")).map(|pair| {
        let number = |name| attribute(pair[0], name).expect("a text has a position");
        let (x, y, size) = (number("x"), number("y"), number("font-size"));
        // `text_width` takes plotters' size, 1.24 times the font size.
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

/// Asserts that no disc, polyline, polygon or text lies outside the figure, no texts overlap, and all numbers are finite.
pub(crate) fn check(name: &str, svg: &str) {
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"), "{name}");
    assert!(!svg.contains("NaN") && !svg.contains("inf\""), "{name}");
    let (_, view) = svg.split_once("viewBox=\"0 0 ").expect("an SVG has a view box");
    let size: Vec<f64> =
        view.split(['"', ' ']).take(2).map(|n| n.parse().expect("a size is a number")).collect();
    let inside = |x: f64, y: f64| (0.0..=size[0]).contains(&x) && (0.0..=size[1]).contains(&y);
    for line in svg.lines() {
        if let (Some(x), Some(y)) = (attribute(line, "cx"), attribute(line, "cy")) {
            let r = attribute(line, "r").unwrap_or(0.0);
            assert!(inside(x - r, y - r) && inside(x + r, y + r), "{name}: {line} is outside");
        }
        let points = line.split_once(" points=\"").map_or("", |(_, rest)| rest.trim_end_matches("\"/>"));
        for pair in points.split_whitespace() {
            let (x, y) = pair.split_once(',').expect("a pair");
            let point = (x.parse().expect("a number"), y.parse().expect("a number"));
            assert!(inside(point.0, point.1), "{name}: {point:?} is outside");
        }
    }
    let texts = texts(svg);
    for (i, ([left, right, top, bottom], text)) in texts.iter().enumerate() {
        assert!(inside(*left, *top) && inside(*right, *bottom), "{name}: {text} is outside");
        for ([l, r, t, b], other) in &texts[..i] {
            let apart = right <= l || r <= left || bottom <= t || b <= top;
            assert!(apart, "{name}: {text} overlaps {other}");
        }
    }
}
