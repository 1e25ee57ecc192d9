//! Markers: a shape for each colour of the palette, so that lines can be distinguished without colour.

use plotters::prelude::*;

use super::canvas::{Canvas, DrawResult, Pixel, area};
use super::palette::{COUNT, colour};

const CROSS: [(f64, f64); 12] = [
    (-0.4, -1.2),
    (0.4, -1.2),
    (0.4, -0.4),
    (1.2, -0.4),
    (1.2, 0.4),
    (0.4, 0.4),
    (0.4, 1.2),
    (-0.4, 1.2),
    (-0.4, 0.4),
    (-1.2, 0.4),
    (-1.2, -0.4),
    (-0.4, -0.4),
];

/// Corners of the marker at `index`, in units of its radius; empty for a disc.
fn corners(index: usize) -> &'static [(f64, f64)] {
    match index % COUNT {
        1 => &[(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)],
        2 => &[(0.0, -1.25), (1.15, 0.85), (-1.15, 0.85)],
        3 => &[(0.0, -1.4), (1.1, 0.0), (0.0, 1.4), (-1.1, 0.0)],
        4 => &[(0.0, 1.25), (1.15, -0.85), (-1.15, -0.85)],
        5 => &CROSS,
        6 => &[(-1.4, -0.6), (1.4, -0.6), (1.4, 0.6), (-1.4, 0.6)],
        _ => &[],
    }
}

/// Draws the marker at `index`: a filled shape with a white rim.
pub(crate) fn draw_marker(root: &Canvas, index: usize, (x, y): Pixel) -> DrawResult {
    let corners = corners(index);
    for (radius, colour) in [(13.0, WHITE), (9.0, colour(index))] {
        if corners.is_empty() {
            root.draw(&Circle::new((x, y), radius as i32, colour.filled()))?;
        } else {
            let corner =
                |&(dx, dy): &(f64, f64)| (x + (dx * radius).round() as i32, y + (dy * radius).round() as i32);
            area(root, corners.iter().map(corner).collect(), colour.filled())?;
        }
    }
    Ok(())
}

/// Points along a polyline, `distance` drawn pixels apart; the first lies `first` pixels from its start.
pub(crate) fn pixels_along(points: &[Pixel], first: f64, distance: f64) -> Vec<Pixel> {
    let mut found = Vec::new();
    let mut remaining = first;
    for pair in points.windows(2) {
        let ((x, y), (to_x, to_y)) = (pair[0], pair[1]);
        let (dx, dy) = (f64::from(to_x - x), f64::from(to_y - y));
        let length = dx.hypot(dy);
        while remaining <= length && length > 0.0 {
            let fraction = remaining / length;
            found.push((x + (dx * fraction).round() as i32, y + (dy * fraction).round() as i32));
            remaining += distance;
        }
        remaining -= length;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_along_a_line_are_evenly_spaced() {
        let bent = [(0, 0), (10, 0), (10, 30)];
        assert_eq!(pixels_along(&bent, 5.0, 10.0), [(5, 0), (10, 5), (10, 15), (10, 25)]);
        assert!(pixels_along(&bent[..1], 5.0, 10.0).is_empty());
        assert!(pixels_along(&[(3, 3), (3, 3)], 0.0, 10.0).is_empty());
    }
}
