//! Large scenarios with hundreds of static shapes.

use bevy::math::{Vec2, vec2};
use wayfield::random::{self, uniform, uniform_01};
use wayfield::scenario::{
    Enclosure, Obstacle, ObstacleMotion, PlacementRule, Scenario, Shape, TaskRules, Wall,
};

/// The number of cells along a side of the field of [`barn`].
const FIELD_CELLS: usize = 30;
/// The side of such a cell, in m.
const CELL_M: f32 = 0.15;
/// The number of circles in [`barn`].
const CIRCLES: usize = 277;

/// A field of 4.5 m x 4.5 m with 277 circles of radius 0.075 m, as in the benchmark BARN: filled cells of a cellular
/// automaton. It is the first random field with this number of circles.
pub fn barn() -> Scenario {
    let side_m = FIELD_CELLS as f32 * CELL_M;
    let cells = (0..).map(filled_cells).find(|cells| cells.len() == CIRCLES).unwrap_or_default();
    let centre = |cell: usize| (cell as f32 + 0.5) * CELL_M - side_m / 2.0;
    let circles = cells.into_iter().map(|(column, row)| {
        still(Shape::Circle { radius_m: CELL_M / 2.0 }, vec2(centre(column), centre(row)))
    });
    Scenario {
        name: "BARN".into(),
        enclosure: Enclosure::Rectangle { width_m: side_m, height_m: side_m },
        obstacles: circles.collect(),
        starts: PlacementRule::Random { clearance_m: 0.2 },
        goals: PlacementRule::Random { clearance_m: 0.2 },
        ..Scenario::default()
    }
}

/// The filled cells (column, row) of a random field. At first, about 28 % are filled. In each of three passes, a cell with at
/// least five filled neighbours is filled, and one with at most one is emptied.
fn filled_cells(seed: u64) -> Vec<(usize, usize)> {
    let mut stream = random::stream(seed, "barn", 0);
    let mut filled: Vec<bool> =
        (0..FIELD_CELLS * FIELD_CELLS).map(|_| uniform_01(&mut stream) < 0.28).collect();
    let near = |at: usize| at.saturating_sub(1)..=(at + 1).min(FIELD_CELLS - 1);
    for _ in 0..3 {
        let before = filled.clone();
        for (index, cell) in filled.iter_mut().enumerate() {
            let around = near(index / FIELD_CELLS)
                .flat_map(|row| near(index % FIELD_CELLS).map(move |column| row * FIELD_CELLS + column));
            match around.filter(|&other| other != index && before[other]).count() {
                0 | 1 => *cell = false,
                2..=4 => {}
                _ => *cell = true,
            }
        }
    }
    let indices = filled.iter().enumerate().filter(|(_, filled)| **filled);
    indices.map(|(index, _)| (index % FIELD_CELLS, index / FIELD_CELLS)).collect()
}

/// The number of rooms along a side of [`office`].
const ROOMS: usize = 10;
/// The side of a room of [`office`], in m.
const ROOM_M: f32 = 5.0;

/// An office of 50 m x 50 m: 100 rooms with two desks and two chairs each, and a door in every wall between two rooms. It has
/// 360 wall segments and 400 obstacles.
pub fn office() -> Scenario {
    let mut stream = random::stream(1, "office", 0);
    let (side_m, door_m) = (ROOMS as f32 * ROOM_M, 1.2);
    let corner = |room: usize| room as f32 * ROOM_M - side_m / 2.0;
    let mut walls = Vec::new();
    for (line, room) in (1..ROOMS).flat_map(|line| (0..ROOMS).map(move |room| (line, room))) {
        for turned in [false, true] {
            let at = |along: f32| if turned { vec2(along, corner(line)) } else { vec2(corner(line), along) };
            let door = corner(room) + uniform(&mut stream, 0.3, ROOM_M - door_m - 0.3);
            for ends in [(corner(room), door), (door + door_m, corner(room + 1))] {
                walls.push(Wall {
                    corners_m: vec![at(ends.0), at(ends.1)],
                    thickness_m: 0.1,
                    ..Wall::default()
                });
            }
        }
    }
    let mut obstacles = Vec::new();
    for (column, row) in (0..ROOMS).flat_map(|column| (0..ROOMS).map(move |row| (column, row))) {
        for quarter in [vec2(1.3, 1.3), vec2(3.7, 1.3), vec2(1.3, 3.7), vec2(3.7, 3.7)] {
            let shift = vec2(uniform(&mut stream, -0.3, 0.3), uniform(&mut stream, -0.3, 0.3));
            let shape = match obstacles.len() % 2 {
                0 => Shape::Rectangle { width_m: 1.6, height_m: 0.8 },
                _ => Shape::Circle { radius_m: 0.25 },
            };
            obstacles.push(Obstacle {
                rotation_rad: uniform(&mut stream, -3.0, 3.0),
                ..still(shape, vec2(corner(column), corner(row)) + quarter + shift)
            });
        }
    }
    Scenario {
        name: "Office".into(),
        enclosure: Enclosure::Rectangle { width_m: side_m, height_m: side_m },
        walls,
        obstacles,
        task: TaskRules { max_episode_steps: 2_000, ..TaskRules::default() },
        ..Scenario::default()
    }
}

fn still(shape: Shape, position_m: Vec2) -> Obstacle {
    Obstacle { shape, position_m, rotation_rad: 0.0, motion: ObstacleMotion::Static }
}
