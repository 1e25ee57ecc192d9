//! A sum tree, which samples an index in O(log n), with a probability proportional to the index's weight.
//!
//! In: a weight per index, and a point between 0 and their sum. Out: the index whose interval contains the point when the
//! weights are laid end to end (Schaul et al. 2016, appendix B.2.1).
//!
//! Weights are f64. In f32, the sum of 10^6 weights has a resolution of 1 part in 10^7, so small weights would be lost at
//! the default replay capacity of 10^6. At that capacity, the f64 tree takes 8 MB more.

/// A binary tree over the weights of `capacity` indices: each node is the sum of its children.
#[derive(Debug, Clone, PartialEq)]
pub struct SumTree {
    /// A complete binary tree: the root is at 1, the children of i are at 2i and 2i + 1, the leaves start at `leaves`.
    nodes: Vec<f64>,
    leaves: usize,
    capacity: usize,
}

impl SumTree {
    /// A tree with all weights 0. `capacity` is at least 1. The zeroed memory takes no space until it is first written:
    /// the operating system provides it page by page.
    #[must_use]
    pub fn new(capacity: usize) -> Self {
        let leaves = capacity.max(1).next_power_of_two();
        Self { nodes: vec![0.0; 2 * leaves], leaves, capacity: capacity.max(1) }
    }

    /// The number of indices.
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

    /// Sets the weight of `index` (< capacity) to `weight` (finite, not negative).
    ///
    /// Each parent is recomputed as the sum of its children, not changed by a difference. Therefore rounding errors do not
    /// accumulate, and the inner nodes depend on the leaves alone: a checkpoint stores only the leaves.
    pub fn set(&mut self, index: usize, weight: f64) {
        let (mut node, mut sum) = (self.leaves + index, weight);
        self.nodes[node] = sum;
        while node > 1 {
            sum += self.nodes[node ^ 1];
            node /= 2;
            self.nodes[node] = sum;
        }
    }

    /// Sets all weights, in O(n). `weights` has at most `capacity` elements; the remaining weights are 0.
    pub fn set_all(&mut self, weights: impl Iterator<Item = f64>) {
        self.nodes.fill(0.0);
        for (node, weight) in self.nodes[self.leaves..].iter_mut().zip(weights) {
            *node = weight;
        }
        for node in (1..self.leaves).rev() {
            self.nodes[node] = self.nodes[2 * node] + self.nodes[2 * node + 1];
        }
    }

    /// The index at `point` (0 <= point < total) when the weights are laid end to end in the order of their indices.
    /// Despite rounding, an index of weight 0 is never found while the total is above 0.
    #[must_use]
    pub fn find(&self, point: f64) -> usize {
        let mut found = [(1, point)];
        self.descend(&mut found);
        found[0].0 - self.leaves
    }

    /// Writes the result of [`Self::find`] for each of `points` into `found`. All points descend the tree level by level
    /// together, so that their memory accesses overlap.
    pub fn find_all(&self, points: impl Iterator<Item = f64>, found: &mut Vec<usize>) {
        let mut descents: Vec<_> = points.map(|point| (1, point)).collect();
        self.descend(&mut descents);
        found.clear();
        found.extend(descents.iter().map(|(node, _)| node - self.leaves));
    }

    /// Moves each (node, point within it) down to its leaf. All nodes start at the same depth.
    fn descend(&self, descents: &mut [(usize, f64)]) {
        let mut level = 1;
        while level < self.leaves {
            for (node, point) in &mut *descents {
                let [left, right] = [self.nodes[2 * *node], self.nodes[2 * *node + 1]];
                // Branch-free, because the CPU cannot predict the direction.
                let to_right = (*point >= left) & (right > 0.0);
                *point -= left * f64::from(to_right);
                *node = 2 * *node + usize::from(to_right);
            }
            level *= 2;
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use wayfield_random::{stream, uniform_01};

    /// The reference: subtracts the weights in order until the point is used up.
    fn find_linearly(weights: &[f64], mut point: f64) -> usize {
        for (index, weight) in weights.iter().enumerate() {
            if point < *weight {
                return index;
            }
            point -= weight;
        }
        weights.len() - 1
    }

    proptest! {
        #[test]
        fn the_tree_finds_what_a_linear_search_finds(
            // Small whole numbers, so that all sums are exact.
            start in prop::collection::vec(0_u32..20, 1..70),
            changes in prop::collection::vec((any::<prop::sample::Index>(), 0_u32..20), 0..100),
        ) {
            let mut weights: Vec<f64> = start.iter().map(|&w| f64::from(w)).collect();
            let mut tree = SumTree::new(weights.len());
            tree.set_all(weights.iter().copied());
            for (at, weight) in changes {
                let at = at.index(weights.len());
                weights[at] = f64::from(weight);
                tree.set(at, f64::from(weight));
                prop_assert_eq!(tree.get(at), f64::from(weight));
            }
            let total: f64 = weights.iter().sum();
            prop_assert_eq!(tree.total(), total);
            let points: Vec<_> = (0..total as u32).map(|point| f64::from(point) + 0.5).collect();
            let mut found = vec![7];
            tree.find_all(points.iter().copied(), &mut found);
            prop_assert_eq!(found.len(), points.len());
            for (point, found) in points.into_iter().zip(found) {
                prop_assert_eq!(found, find_linearly(&weights, point));
                prop_assert_eq!(found, tree.find(point));
            }
        }

        #[test]
        fn set_and_set_all_give_the_same_tree(weights in prop::collection::vec(0.0..1.0_f64, 1..70)) {
            let (mut one, mut all) = (SumTree::new(weights.len()), SumTree::new(weights.len()));
            for (index, &weight) in weights.iter().enumerate().rev() {
                one.set(index, 7.0);
                one.set(index, weight);
            }
            all.set_all(weights.into_iter());
            prop_assert_eq!(one, all, "inner nodes depend on the leaves alone");
        }

        #[test]
        fn rounding_never_finds_a_weight_of_zero(
            weights in prop::collection::vec(prop_oneof![Just(0.0), 1e-12..1e12_f64], 1..70),
            fraction in 0.0..=1.0_f64,
        ) {
            let mut tree = SumTree::new(weights.len());
            tree.set_all(weights.iter().copied());
            prop_assume!(tree.total() > 0.0);
            let found = tree.find(tree.total() * fraction);
            prop_assert!(weights[found] > 0.0, "index {found} has weight 0");
        }
    }

    #[test]
    fn draws_are_proportional_to_the_weights() {
        let weights = [1.0, 0.0, 2.0, 3.0, 0.5, 3.5];
        let mut tree = SumTree::new(weights.len());
        tree.set_all(weights.into_iter());
        let (mut counts, draws) = ([0.0; 6], 100_000);
        let mut random = stream(5, "test", 0);
        for _ in 0..draws {
            counts[tree.find(tree.total() * f64::from(uniform_01(&mut random)))] += 1.0;
        }
        assert_eq!(counts[1], 0.0, "weight 0 is never drawn");
        // A fair sampler exceeds this chi-square (4 degrees of freedom) one time in a thousand.
        let expected = |w: f64| w / 10.0 * f64::from(draws);
        let pairs = weights.iter().zip(counts).filter(|(w, _)| **w > 0.0);
        let chi_square: f64 = pairs.map(|(&w, n)| (n - expected(w)).powi(2) / expected(w)).sum();
        assert!(chi_square < 18.5, "chi-square {chi_square}: {counts:?}");
    }
}
