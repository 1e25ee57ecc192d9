//! Mazes: straight passages between nodes on a grid, with walls or solid blocks around them.

use wayfield_random::{Stream, uniform_01};

use super::blocks::Blocks;
use super::draft::Draft;
use super::{number, one_of};

/// Adds a maze with passages about `passage_m` wide and walls `wall_m` thick. `loops` is the probability that a dead end is
/// opened. All three are ranges to draw from.
pub(super) fn add(
    draft: &mut Draft,
    passage_m: (f32, f32),
    wall_m: (f32, f32),
    loops: (f32, f32),
    stream: &mut Stream,
) {
    let (passage_m, wall_m, loops) =
        (number(stream, passage_m), number(stream, wall_m), number(stream, loops));
    let size = draft.size_m();
    let (xs, ys) = (edges(size.x, passage_m, wall_m), edges(size.y, passage_m, wall_m));
    let solid = vec![true; (xs.len() - 1) * (ys.len() - 1)];
    let mut maze = Maze { blocks: Blocks { xs, ys, solid } };
    maze.carve(stream);
    maze.open_dead_ends(loops, stream);
    maze.blocks.add_to(draft);
}

/// The edges of alternating passages and walls along a side of length `size_m`, from a passage to a passage. The passages are
/// wider than `passage_m` where that is needed to fill the side.
fn edges(size_m: f32, passage_m: f32, wall_m: f32) -> Vec<f32> {
    let passages = (((size_m + wall_m) / (passage_m + wall_m) * (1.0 + 1e-6)) as usize).max(1);
    let wide = (size_m - (passages - 1) as f32 * wall_m) / passages as f32;
    let edge = |k: usize| (k / 2) as f32 * (wide + wall_m) + if k.is_multiple_of(2) { 0.0 } else { wide };
    (0..2 * passages).map(|k| edge(k) - size_m / 2.0).collect()
}

/// The blocks in even columns and rows.
fn nodes_of(blocks: &Blocks) -> Vec<usize> {
    let (columns, rows) = (blocks.columns(), blocks.rows());
    (0..rows)
        .step_by(2)
        .flat_map(|row| (0..columns).step_by(2).map(move |column| row * columns + column))
        .collect()
}

/// A maze. The blocks in even columns and rows are its nodes; each block between two nodes is a passage or a wall.
struct Maze {
    blocks: Blocks,
}

impl Maze {
    /// The nodes next to `node`, each with the block between them.
    fn steps(&self, node: usize) -> Vec<(usize, usize)> {
        let between = self.blocks.neighbours(node);
        // The index of the block between two nodes is the mean of theirs.
        between.map(|between| (2 * between - node, between)).collect()
    }

    /// Opens passages so that exactly one path connects any two nodes, by a random walk with backtracking.
    fn carve(&mut self, stream: &mut Stream) {
        self.blocks.solid[0] = false;
        let mut path = vec![0];
        while let Some(&node) = path.last() {
            let mut steps = self.steps(node);
            steps.retain(|&(next, _)| self.blocks.solid[next]);
            match one_of(&steps, stream) {
                Some(&(next, between)) => {
                    self.blocks.solid[next] = false;
                    self.blocks.solid[between] = false;
                    path.push(next);
                }
                None => drop(path.pop()),
            }
        }
    }

    /// Opens a second passage at each dead end with the probability `loops`.
    fn open_dead_ends(&mut self, loops: f32, stream: &mut Stream) {
        for node in nodes_of(&self.blocks) {
            let (closed, open): (Vec<_>, Vec<_>) =
                self.steps(node).into_iter().partition(|&(_, between)| self.blocks.solid[between]);
            if open.len() == 1
                && uniform_01(stream) < loops
                && let Some(&(_, between)) = one_of(&closed, stream)
            {
                self.blocks.solid[between] = false;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wayfield_random::stream;

    fn maze(loops: f32) -> Blocks {
        let (xs, ys) = (edges(7.0, 0.9, 0.1), edges(5.0, 0.9, 0.1));
        let solid = vec![true; (xs.len() - 1) * (ys.len() - 1)];
        let mut maze = Maze { blocks: Blocks { xs, ys, solid } };
        let mut stream = stream(5, "maze", 0);
        maze.carve(&mut stream);
        maze.open_dead_ends(loops, &mut stream);
        maze.blocks
    }

    #[test]
    fn passages_and_walls_cover_the_enclosure() {
        let edges = edges(4.8, 1.0, 0.2);
        assert_eq!(edges.len(), 8, "four passages and three walls");
        assert!((edges[0] + 2.4).abs() < 1e-6 && (edges[7] - 2.4).abs() < 1e-6);
        assert!((edges[1] - edges[0] - 1.05).abs() < 1e-6, "widened from 1.0 m");
        assert!((edges[2] - edges[1] - 0.2).abs() < 1e-6);
    }

    #[test]
    fn without_loops_the_passages_form_a_tree_and_with_all_loops_there_are_no_dead_ends() {
        let open = |blocks: &Blocks| blocks.solid.iter().filter(|&&solid| !solid).count();
        let tree = maze(0.0);
        let nodes = nodes_of(&tree).len();
        assert_eq!(open(&tree), 2 * nodes - 1, "a tree of {nodes} nodes");
        let looped = maze(1.0);
        assert!(open(&looped) > open(&tree));
        for node in nodes_of(&looped) {
            assert!(looped.neighbours(node).filter(|&next| !looped.solid[next]).count() > 1, "{node}");
        }
    }
}
