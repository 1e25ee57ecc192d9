//! A sum tree: draws an index with chance proportional to its weight, in O(log n).
//!
//! In: a weight per index. Out: the index under any point of the weights laid end to end (Schaul et al. 2016,
//! appendix B.2.1).
//!
//! Weights are f64. An f32 root over 10^6 leaves resolves 1 part in 10^7: a small priority beside it would be lost,
//! and the draw would be unfair at exactly the sizes that Table 1 asks for. The f64 tree costs 8 MB more there.

/// The weights of `capacity` indices and all their partial sums.
#[derive(Debug, Clone, PartialEq)]
pub struct SumTree {
    /// A complete binary tree: the root is at 1, the children of i at 2i and 2i + 1, leaves from `leaves` on.
    nodes: Vec<f64>,
    leaves: usize,
    capacity: usize,
}

impl SumTree {
    /// All weights 0. `capacity` is at least 1. The memory is zeroed by the operating system, page by page, when
    /// it is first touched.
    #[must_use]
    pub fn new(capacity: usize) -> Self {
        let leaves = capacity.max(1).next_power_of_two();
        Self { nodes: vec![0.0; 2 * leaves], leaves, capacity: capacity.max(1) }
    }

    /// How many indices there are.
    #[must_use]
    pub fn capacity(&self) -> usize {
        self.capacity
    }

    /// The weight of `index` (< capacity).
    #[must_use]
    pub fn get(&self, index: usize) -> f64 {
        self.nodes[self.leaves + index]
    }

    /// The sum of all weights.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.nodes[1]
    }

    /// Gives `index` (< capacity) the `weight` (finite, not negative).
    ///
    /// Each parent is the sum of its two children, computed anew and not by adding differences: so no error
    /// accumulates, and the inner nodes are a function of the leaves alone (a checkpoint need only keep leaves).
    pub fn set(&mut self, index: usize, weight: f64) {
        let mut node = self.leaves + index;
        self.nodes[node] = weight;
        while node > 1 {
            node /= 2;
            self.nodes[node] = self.nodes[2 * node] + self.nodes[2 * node + 1];
        }
    }

    /// Gives every index its weight of `weights` (at most capacity many, the rest 0), in O(n).
    pub fn set_all(&mut self, weights: impl Iterator<Item = f64>) {
        self.nodes.fill(0.0);
        for (node, weight) in self.nodes[self.leaves..].iter_mut().zip(weights) {
            *node = weight;
        }
        for node in (1..self.leaves).rev() {
            self.nodes[node] = self.nodes[2 * node] + self.nodes[2 * node + 1];
        }
    }

    /// The index under `point` (0 <= point < total) when the weights are laid end to end in the order of their
    /// indices. An index of weight 0 is never found as long as the total is above 0, whatever rounding does.
    #[must_use]
    pub fn find(&self, mut point: f64) -> usize {
        let mut node = 1;
        while node < self.leaves {
            let left = self.nodes[2 * node];
            if point < left || self.nodes[2 * node + 1] <= 0.0 {
                node *= 2;
            } else {
                point -= left;
                node = 2 * node + 1;
            }
        }
        node - self.leaves
    }
}
