//! The inner walls of a level.

use wayfield_random::Stream;

use super::draft::Draft;
use super::rooms::Rooms;
use super::schema::WallLayout;
use super::{cells, maze, number, one_of, rooms, text_grid, traps};

/// Adds one of `layouts`, or nothing if the list is empty.
pub(super) fn add(draft: &mut Draft, layouts: &[WallLayout], stream: &mut Stream) {
    match one_of(layouts, stream) {
        Some(&WallLayout::Cells { cell_m, fill }) => cells::add(draft, cell_m, fill, stream),
        Some(WallLayout::Grid { rows }) => text_grid::add(draft, rows),
        Some(&WallLayout::Rooms { side_m, door_m, loops }) => {
            let rooms = Rooms { side_m: number(stream, side_m), door_m, loops: number(stream, loops) };
            rooms::add(draft, rooms, stream);
        }
        Some(&WallLayout::Maze { passage_m, wall_m, loops }) => {
            maze::add(draft, passage_m, wall_m, loops, stream);
        }
        Some(&WallLayout::Traps { count, width_m, depth_m }) => {
            traps::add(draft, count, width_m, depth_m, stream);
        }
        None => {}
    }
}
