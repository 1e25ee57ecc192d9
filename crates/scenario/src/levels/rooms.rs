//! Rooms: walls with doors divide the enclosure recursively (binary space partitioning).

use glam::{Vec2, vec2};
use wayfield_random::{Stream, uniform, uniform_01};

use super::draft::Draft;
use super::number;
use crate::schema::Wall;

/// Thickness of the walls, in m.
pub(super) const THICKNESS_M: f32 = 0.1;
/// Attempts to find a position for a wall that ends at no door.
const TRIES: usize = 20;

/// The parameters of the rooms of a level.
#[derive(Clone, Copy)]
pub(super) struct Rooms {
    /// Smallest side of a room, in m.
    pub(super) side_m: f32,
    /// The range of door widths, in m.
    pub(super) door_m: (f32, f32),
    /// Probability that a wall has a second door.
    pub(super) loops: f32,
}

/// A wall from one side of a room to the opposite one, and its doors.
struct Partition {
    /// Whether it runs along y.
    upright: bool,
    /// Its coordinate on the other axis.
    at_m: f32,
    /// The two ends of each door, as coordinates along the wall.
    doors_m: Vec<(f32, f32)>,
}

/// Divides the enclosure into rooms.
pub(super) fn add(draft: &mut Draft, rooms: Rooms, stream: &mut Stream) {
    let (low, high) = draft.scenario.enclosure.bounds_m();
    let mut partitions = Vec::new();
    let mut open = vec![(low, high)];
    while let Some((low, high)) = open.pop() {
        let Some(partition) = rooms.divide(low, high, &partitions, stream) else { continue };
        if partition.upright {
            open.extend([(low, vec2(partition.at_m, high.y)), (vec2(partition.at_m, low.y), high)]);
        } else {
            open.extend([(low, vec2(high.x, partition.at_m)), (vec2(low.x, partition.at_m), high)]);
        }
        let (from, to) = if partition.upright { (low.y, high.y) } else { (low.x, high.x) };
        for wall in partition.walls(from, to) {
            draft.add_wall(wall);
        }
        partitions.push(partition);
    }
}

impl Rooms {
    /// A wall that divides the longer side of the room with the corners `low` and `high`; `None` if the room is too small, or
    /// if no position is found that leaves all doors open.
    fn divide(
        self,
        low: Vec2,
        high: Vec2,
        partitions: &[Partition],
        stream: &mut Stream,
    ) -> Option<Partition> {
        let size = high - low;
        let upright = size.x >= size.y;
        let (least, most, along) = if upright {
            (low.x + self.side_m, high.x - self.side_m, (low.y, high.y))
        } else {
            (low.y + self.side_m, high.y - self.side_m, (low.x, high.x))
        };
        if least > most {
            return None;
        }
        let is_clear = |at_m: f32| partitions.iter().all(|other| other.allows(upright, at_m, along));
        let at_m = (0..TRIES).map(|_| uniform(stream, least, most)).find(|&at_m| is_clear(at_m))?;
        Some(Partition { upright, at_m, doors_m: self.doors(along, stream) })
    }

    /// The doors of a wall between two coordinates: one, or one in each half.
    fn doors(self, (from, to): (f32, f32), stream: &mut Stream) -> Vec<(f32, f32)> {
        let middle = (from + to) / 2.0;
        let halves = [(from, middle), (middle, to)];
        let parts = if uniform_01(stream) < self.loops { &halves[..] } else { &[(from, to)] };
        let door = |&(from, to): &(f32, f32)| {
            // At least half a wall's thickness remains on either side.
            let wide = number(stream, self.door_m).min(to - from - THICKNESS_M);
            let start = uniform(stream, from + THICKNESS_M / 2.0, to - THICKNESS_M / 2.0 - wide);
            (start, start + wide)
        };
        parts.iter().map(door).collect()
    }
}

impl Partition {
    /// Whether this wall's doors stay open if another wall at `at_m` has the ends `along`. Only a wall across this one that
    /// ends at it can block them.
    fn allows(&self, upright: bool, at_m: f32, along: (f32, f32)) -> bool {
        let touches = self.at_m == along.0 || self.at_m == along.1;
        let rim = THICKNESS_M / 2.0;
        let blocks = |door: &(f32, f32)| door.0 - rim < at_m && at_m < door.1 + rim;
        self.upright == upright || !touches || !self.doors_m.iter().any(blocks)
    }

    /// The pieces of this wall between its doors, if the wall runs from coordinate `from` to coordinate `to`. A piece extends
    /// half its thickness beyond its ends.
    fn walls(&self, from: f32, to: f32) -> Vec<Wall> {
        let point = |along: f32| if self.upright { vec2(self.at_m, along) } else { vec2(along, self.at_m) };
        let rim = THICKNESS_M / 2.0;
        let starts = std::iter::once(from).chain(self.doors_m.iter().map(|door| door.1 + rim));
        let ends = self.doors_m.iter().map(|door| door.0 - rim).chain([to]);
        let pieces = starts.zip(ends).filter(|(start, end)| end > start);
        pieces
            .map(|(start, end)| Wall {
                corners_m: vec![point(start), point(end)],
                thickness_m: THICKNESS_M,
                ..Wall::default()
            })
            .collect()
    }
}
