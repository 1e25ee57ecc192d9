//! The outlines of a set of cells, and their simplification.

use glam::{DVec2, dvec2};

use crate::grid::Grid;

/// The outlines of the set: closed rings of corners, in units of cells, without collinear corners. The set lies to the
/// left of each ring, so outer rings are counterclockwise and holes clockwise. Cells that touch only at a corner are separate.
pub fn rings(set: &Grid<bool>) -> Vec<Vec<DVec2>> {
    let is_in = |column: i64, row: i64| {
        let inside = 0 <= column && column < set.columns as i64 && 0 <= row && row < set.rows as i64;
        inside && set.at((column as usize, row as usize))
    };
    // Whether a side with the set to its left starts at the corner (x, y) in a direction: 0 right, 1 up, 2 left, 3 down.
    let leaves = |(x, y): (i64, i64), direction: usize| {
        let (left, right) = match direction {
            0 => ((x, y), (x, y - 1)),
            1 => ((x - 1, y), (x, y)),
            2 => ((x - 1, y - 1), (x - 1, y)),
            _ => ((x, y - 1), (x - 1, y - 1)),
        };
        is_in(left.0, left.1) && !is_in(right.0, right.1)
    };
    // Each ring is found by one of its sides that runs to the right.
    let mut used = Grid::filled(set.columns, set.rows + 1, false);
    let mut rings = Vec::new();
    for (column, row) in used.cells() {
        let first = (column as i64, row as i64);
        if used.at((column, row)) || !leaves(first, 0) {
            continue;
        }
        let (mut corner, mut direction, mut ring) = (first, 0, Vec::new());
        loop {
            if direction == 0 {
                used.set((corner.0 as usize, corner.1 as usize), true);
            }
            let (dx, dy) = [(1, 0), (0, 1), (-1, 0), (0, -1)][direction];
            corner = (corner.0 + dx, corner.1 + dy);
            // Left is tried first: where two cells touch at a corner, the ring stays at the same cell.
            let next =
                [1, 0, 3].map(|turn| (direction + turn) % 4).into_iter().find(|&next| leaves(corner, next));
            let Some(next) = next else { break };
            if next != direction {
                ring.push(dvec2(corner.0 as f64, corner.1 as f64));
            }
            direction = next;
            if corner == first && direction == 0 {
                break;
            }
        }
        rings.push(ring);
    }
    rings
}

/// Simplifies `ring` (Douglas and Peucker, 1973). Returns the corners that remain, at least two if `ring` has two, and an upper
/// bound, at most `tolerance`, on the distance of a dropped corner from the new outline.
pub fn simplified(ring: &[DVec2], tolerance: f64) -> (Vec<DVec2>, f64) {
    let Some(&first) = ring.first() else { return (Vec::new(), 0.0) };
    let farthest = (0..ring.len()).max_by(|&a, &b| {
        first.distance_squared(ring[a]).total_cmp(&first.distance_squared(ring[b])).then(b.cmp(&a))
    });
    let opposite = farthest.unwrap_or(0);
    let closed: Vec<DVec2> = ring.iter().copied().chain([first]).collect();
    let mut kept = vec![false; closed.len()];
    (kept[0], kept[opposite]) = (true, true);
    let (mut open, mut deviation) = (vec![(0, opposite), (opposite, ring.len())], 0.0_f64);
    while let Some((from, to)) = open.pop() {
        let distance = |k: usize| distance_to_segment(closed[k], closed[from], closed[to]);
        let farthest =
            (from + 1..to).map(|k| (distance(k), k)).max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
        match farthest {
            Some((distance, k)) if distance > tolerance => {
                kept[k] = true;
                open.extend([(from, k), (k, to)]);
            }
            Some((distance, _)) => deviation = deviation.max(distance),
            None => {}
        }
    }
    let corners = ring.iter().zip(kept).filter_map(|(&corner, is_kept)| is_kept.then_some(corner));
    (corners.collect(), deviation)
}

/// The corners of the convex hull, counterclockwise, without collinear points (Andrew's monotone chain).
pub fn convex_hull(points: &[DVec2]) -> Vec<DVec2> {
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    sorted.dedup();
    let half = |points: &mut dyn Iterator<Item = DVec2>| {
        let mut chain: Vec<DVec2> = Vec::new();
        for point in points {
            while let [.., a, b] = chain[..]
                && (b - a).perp_dot(point - b) <= 0.0
            {
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop();
        chain
    };
    let mut hull = half(&mut sorted.iter().copied());
    hull.extend(half(&mut sorted.iter().rev().copied()));
    hull
}

/// The largest distance from a corner of `ring` to the closed outline through `corners`.
pub fn deviation(ring: &[DVec2], corners: &[DVec2]) -> f64 {
    let ends = || corners.iter().zip(corners.iter().cycle().skip(1));
    let to_outline = |&corner: &DVec2| {
        ends().map(|(&a, &b)| distance_to_segment(corner, a, b)).fold(f64::INFINITY, f64::min)
    };
    ring.iter().map(to_outline).fold(0.0, f64::max)
}

fn distance_to_segment(point: DVec2, a: DVec2, b: DVec2) -> f64 {
    let along = b - a;
    let fraction = ((point - a).dot(along) / along.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    point.distance(a + fraction * along)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(rows: &[&str]) -> Grid<bool> {
        let values = rows.iter().rev().flat_map(|row| row.bytes().map(|byte| byte == b'.')).collect();
        Grid { columns: rows[0].len(), rows: rows.len(), values }
    }

    fn area(ring: &[DVec2]) -> f64 {
        let ends = ring.iter().zip(ring.iter().cycle().skip(1));
        ends.map(|(a, b)| a.perp_dot(*b) / 2.0).sum()
    }

    #[test]
    fn the_outer_ring_runs_counterclockwise_and_holes_clockwise() {
        let found = rings(&set(&["....", ".##.", "...."]));
        assert_eq!(found.iter().map(|ring| area(ring)).collect::<Vec<_>>(), [12.0, -2.0]);
        assert!(
            found.iter().all(|ring| ring.len() == 4),
            "corners on straight lines are left out: {found:?}"
        );
    }

    #[test]
    fn the_areas_of_all_rings_add_up_to_the_number_of_cells() {
        let cells = set(&[".#.#..", "#.#.#.", "..#..#", ".#.###"]);
        let total: f64 = rings(&cells).iter().map(|ring| area(ring)).sum();
        assert_eq!(total, cells.members().count() as f64);
    }

    #[test]
    fn stairs_become_a_straight_line_within_the_tolerance() {
        let stairs: Vec<DVec2> = (0..20)
            .flat_map(|k| [dvec2(f64::from(k), f64::from(k)), dvec2(f64::from(k + 1), f64::from(k))])
            .collect();
        let ring: Vec<DVec2> = stairs.into_iter().chain([dvec2(20.0, 20.0), dvec2(0.0, 20.0)]).collect();
        let (short, deviation_of_short) = simplified(&ring, 1.0);
        assert!(short.len() <= 4, "{short:?}");
        assert!(deviation(&ring, &short) <= deviation_of_short && deviation_of_short <= 1.0);
        assert_eq!(simplified(&ring, 0.0).0.len(), ring.len());
    }

    #[test]
    fn the_hull_of_a_cross_is_an_octagon() {
        let corners = rings(&set(&["#.#", "...", "#.#"]));
        assert_eq!(convex_hull(&corners[0]).len(), 8);
    }
}
