//! Walls of random solid cells, as in the levels of JaxNav (Rutherford et al. 2024, "No Regrets").

use wayfield_random::{Stream, uniform_01};

use super::blocks::Blocks;
use super::draft::Draft;
use super::number;

/// Makes random cells of the enclosure solid. Cells that are cut off from the largest free area become solid, too.
pub(super) fn add(draft: &mut Draft, cell_m: (f32, f32), fill: (f32, f32), stream: &mut Stream) {
    let (cell_m, fill) = (number(stream, cell_m), number(stream, fill));
    let size = draft.size_m();
    let fitting = |size_m: f32| ((size_m / cell_m * (1.0 + 1e-6)) as usize).max(1);
    let (xs, ys) = (even_edges(size.x, fitting(size.x)), even_edges(size.y, fitting(size.y)));
    let count = (xs.len() - 1) * (ys.len() - 1);
    let solid = (0..count).map(|_| uniform_01(stream) < fill).collect();
    let mut blocks = Blocks { xs, ys, solid };
    blocks.fill_pockets();
    blocks.add_to(draft);
}

/// The edges of `count` cells of equal width that cover `size_m` around 0.
pub(super) fn even_edges(size_m: f32, count: usize) -> Vec<f32> {
    (0..=count).map(|k| size_m * (k as f32 / count as f32 - 0.5)).collect()
}
