//! Solid blocks on a grid whose columns and rows may differ in size.

use glam::vec2;

use super::draft::Draft;
use crate::schema::{Obstacle, ObstacleMotion, Shape};
use crate::text_rows::merged;

/// A grid of blocks, row by row, some of which are solid.
pub(super) struct Blocks {
    /// The x coordinates of the edges of the columns, in m, in ascending order.
    pub(super) xs: Vec<f32>,
    /// The y coordinates of the edges of the rows, in m, in ascending order.
    pub(super) ys: Vec<f32>,
    /// Whether each block is solid.
    pub(super) solid: Vec<bool>,
}

impl Blocks {
    pub(super) fn columns(&self) -> usize {
        self.xs.len() - 1
    }

    pub(super) fn rows(&self) -> usize {
        self.ys.len() - 1
    }

    /// The blocks that share a side with `block`.
    pub(super) fn neighbours(&self, block: usize) -> impl Iterator<Item = usize> {
        let columns = self.columns();
        let (row, column) = (block / columns, block % columns);
        let left = (column > 0).then(|| block - 1);
        let right = (column + 1 < columns).then(|| block + 1);
        let below = (row > 0).then(|| block - columns);
        let above = (row + 1 < self.rows()).then(|| block + columns);
        [left, right, below, above].into_iter().flatten()
    }

    /// Fills all empty blocks except those of the largest region. Blocks of a region are connected through their sides.
    pub(super) fn fill_pockets(&mut self) {
        let mut seen = self.solid.clone();
        let mut largest = Vec::new();
        for first in 0..seen.len() {
            let mut region = Vec::new();
            let mut open = if seen[first] { Vec::new() } else { vec![first] };
            while let Some(block) = open.pop() {
                if !std::mem::replace(&mut seen[block], true) {
                    region.push(block);
                    open.extend(self.neighbours(block));
                }
            }
            if region.len() > largest.len() {
                largest = region;
            }
        }
        self.solid.fill(true);
        for block in largest {
            self.solid[block] = false;
        }
    }

    /// Adds the solid blocks to the level, merged into rectangles: each as wide as possible, then as high as possible.
    pub(super) fn add_to(&self, draft: &mut Draft) {
        for (columns, rows) in merged(self.solid.clone(), self.columns()) {
            draft.add_obstacle(self.rectangle(columns, rows));
        }
    }

    fn rectangle(&self, columns: std::ops::Range<usize>, rows: std::ops::Range<usize>) -> Obstacle {
        let low = vec2(self.xs[columns.start], self.ys[rows.start]);
        let high = vec2(self.xs[columns.end], self.ys[rows.end]);
        let size = high - low;
        Obstacle {
            shape: Shape::Rectangle { width_m: size.x, height_m: size.y },
            position_m: (low + high) / 2.0,
            rotation_rad: 0.0,
            motion: ObstacleMotion::Static,
        }
    }
}
