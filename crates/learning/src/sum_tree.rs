//! A sum tree: draws an index with chance proportional to its weight, in O(log n).
//!
//! In: a weight per index. Out: the index under any point of the weights laid end to end (Schaul et al. 2016,
//! appendix B.2.1).
//!
//! Weights are f64. An f32 root over 10^6 leaves resolves 1 part in 10^7: a small priority beside it would be
//! lost, and the draw would be unfair at exactly the sizes that Table 1 asks for. The f64 tree costs 8 MB
//! more there.

/// The weights of `capacity` indices and all their partial sums.
#[derive(Debug, Clone, PartialEq)]
pub struct SumTree {
    /// A complete binary tree: the root is at 1, the children of i at 2i and 2i + 1, leaves from `leaves` on.
    nodes: Vec<f64>,
    leaves: usize,
    capacity: usize,
}

impl SumTree {
    /// All weights 0. `capacity` is at least 1. The memory is zeroed by the operating system, page by page,
    /// when it is first touched.
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
    /// accumulates, and the inner nodes are a function of the leaves alone (a checkpoint need only keep
    /// leaves).
    pub fn set(&mut self, index: usize, weight: f64) {
        let (mut node, mut sum) = (self.leaves + index, weight);
        self.nodes[node] = sum;
        while node > 1 {
            sum += self.nodes[node ^ 1];
            node /= 2;
            self.nodes[node] = sum;
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

    /// The index under `point` (0 <= point < total) when the weights are laid end to end in the order of
    /// their indices. An index of weight 0 is never found as long as the total is above 0, whatever rounding
    /// does.
    #[must_use]
    pub fn find(&self, point: f64) -> usize {
        let mut found = [(1, point)];
        self.descend(&mut found);
        found[0].0 - self.leaves
    }

    /// What [`Self::find`] gives for each of `points`, into `found`. All go down the tree side by side, so that
    /// they wait for memory together and not one after the other.
    pub fn find_all(&self, points: impl Iterator<Item = f64>, found: &mut Vec<usize>) {
        let mut walks: Vec<_> = points.map(|point| (1, point)).collect();
        self.descend(&mut walks);
        found.clear();
        found.extend(walks.iter().map(|(node, _)| node - self.leaves));
    }

    /// Walks from each (node, point within it) down to a leaf; all nodes are equally deep.
    fn descend(&self, walks: &mut [(usize, f64)]) {
        let mut level = 1;
        while level < self.leaves {
            for (node, point) in &mut *walks {
                let [left, right] = [self.nodes[2 * *node], self.nodes[2 * *node + 1]];
                // Without branches, which no processor could foretell.
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

    /// The plain way: walk the weights until the point is used up.
    fn find_plainly(weights: &[f64], mut point: f64) -> usize {
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
        fn agrees_with_walking_the_weights(
            // Small whole numbers, so that sums are exact and both ways must agree to the bit.
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
                prop_assert_eq!(found, find_plainly(&weights, point));
                prop_assert_eq!(found, tree.find(point));
            }
        }

        #[test]
        fn one_by_one_or_all_at_once_is_the_same_tree(weights in prop::collection::vec(0.0..1.0_f64, 1..70)) {
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
            share in 0.0..=1.0_f64,
        ) {
            let mut tree = SumTree::new(weights.len());
            tree.set_all(weights.iter().copied());
            prop_assume!(tree.total() > 0.0);
            let found = tree.find(tree.total() * share);
            prop_assert!(weights[found] > 0.0, "found {found}");
        }
    }

    #[test]
    fn draws_are_in_proportion() {
        let weights = [1.0, 0.0, 2.0, 3.0, 0.5, 3.5];
        let mut tree = SumTree::new(weights.len());
        tree.set_all(weights.into_iter());
        let (mut counts, draws) = ([0.0; 6], 100_000);
        let mut random = stream(5, "test", 0);
        for _ in 0..draws {
            counts[tree.find(tree.total() * f64::from(uniform_01(&mut random)))] += 1.0;
        }
        assert_eq!(counts[1], 0.0, "weight 0 is never drawn");
        // Pearson's chi-square with 4 degrees of freedom exceeds 18.5 in one of a thousand fair samplers.
        let expected = |w: f64| w / 10.0 * f64::from(draws);
        let pairs = weights.iter().zip(counts).filter(|(w, _)| **w > 0.0);
        let chi_square: f64 = pairs.map(|(&w, n)| (n - expected(w)).powi(2) / expected(w)).sum();
        assert!(chi_square < 18.5, "chi-square {chi_square}: {counts:?}");
    }
}
