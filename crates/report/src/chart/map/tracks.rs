//! The dotted tracks of moving obstacles.

use plotters::prelude::*;

use super::floor_plan::{FloorPlan, closed, ring};
use super::model::MapTrack;
use crate::style::{Canvas, DrawResult, Pixel, pixels_along};

/// Distance between the dots of a track, in drawn pixels.
const DOT_DISTANCE: f64 = 16.0;
/// Radius of a dot, in drawn pixels.
const DOT_RADIUS: i32 = 3;
const TRACK: RGBColor = RGBColor(172, 137, 76);

/// Draws all tracks; a ring or segment that several tracks share is drawn once.
pub(super) fn draw_tracks(plan: &FloorPlan, root: &Canvas, tracks: &[MapTrack]) -> DrawResult {
    let mut rings = Vec::new();
    let mut segments = Vec::new();
    for track in tracks {
        match track {
            MapTrack::Lines(points) => {
                let pixels = plan.pixels(points);
                segments.extend(pixels.windows(2).map(|ends| (ends[0], ends[1])));
            }
            MapTrack::Ring(x, y, radius) => {
                let pixels = plan.pixels(&ring((*x, *y, *radius)));
                if !rings.contains(&pixels) {
                    rings.push(pixels);
                }
            }
        }
    }
    // The longest segments come first, because a shorter one may lie on them.
    segments.sort_by_key(|&(from, to)| std::cmp::Reverse(distance_squared(from, to)));
    let mut drawn: Vec<(Pixel, Pixel)> = Vec::new();
    for (from, to) in segments {
        if !drawn.iter().any(|&segment| lies_on(from, segment) && lies_on(to, segment)) {
            draw_dots(root, &[from, to])?;
            drawn.push((from, to));
        }
    }
    for pixels in rings {
        draw_dots(root, &closed(pixels))?;
    }
    Ok(())
}

/// Draws evenly spaced dots from one end of a path to the other.
pub(super) fn draw_dots(root: &Canvas, path: &[Pixel]) -> DrawResult {
    let length: f64 = path.windows(2).map(|ends| (distance_squared(ends[0], ends[1]) as f64).sqrt()).sum();
    let distance = length / (length / DOT_DISTANCE).round().max(1.0);
    // The tolerance keeps rounding from dropping the last dot.
    for at in pixels_along(path, 0.0, (distance * 0.9999).max(1.0)) {
        root.draw(&Circle::new(at, DOT_RADIUS, TRACK.filled()))?;
    }
    Ok(())
}

fn distance_squared((from_x, from_y): Pixel, (to_x, to_y): Pixel) -> i64 {
    let (dx, dy) = (i64::from(to_x - from_x), i64::from(to_y - from_y));
    dx * dx + dy * dy
}

/// Whether a point is within two drawn pixels of a segment.
fn lies_on(at: Pixel, (from, to): (Pixel, Pixel)) -> bool {
    let length = (distance_squared(from, to) as f64).sqrt();
    if length < 1.0 {
        return distance_squared(from, at) <= 4;
    }
    let (dx, dy) = (f64::from(to.0 - from.0) / length, f64::from(to.1 - from.1) / length);
    let (x, y) = (f64::from(at.0 - from.0), f64::from(at.1 - from.1));
    (x * dy - y * dx).abs() <= 2.0 && (-2.0..=length + 2.0).contains(&(x * dx + y * dy))
}
