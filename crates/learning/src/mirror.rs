//! Mirror augmentation: experience in a scenario also counts as experience in its mirror image.
//!
//! In: the [`Mirror`] of a task, and a sampled batch. Out: the batch, with each transition mirrored with probability 1/2.
//! The reward and the discount stay the same, so the task must be symmetric: the mirrored action in the mirrored state must have
//! the mirrored result.

use wayfield_random::{Stream, random_u64};

use crate::replay::Batch;

/// The mirror image of observations and actions: a signed permutation of the entries of an observation, and a permutation of
/// the actions. Applied twice, it changes nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct Mirror {
    inputs: Vec<(u32, f32)>,
    actions: Vec<u32>,
}

/// An error in the definition of a [`Mirror`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum MirrorError {
    /// An entry of the observation is not the mirror image of its own mirror image, or its sign is not 1 or -1.
    #[error("entry {0} of the observation is not the mirror image of its own mirror image")]
    Input(usize),
    /// An action is not the mirror image of its own mirror image.
    #[error("action {0} is not the mirror image of its own mirror image")]
    Action(usize),
    /// The mirror belongs to another network.
    #[error("the mirror has {found:?} inputs and actions, but the learner has {expected:?}")]
    Size {
        /// The learner's numbers of inputs and actions.
        expected: (usize, usize),
        /// The mirror's numbers of inputs and actions.
        found: (usize, usize),
    },
}

impl Mirror {
    /// A mirror in which entry i of the mirrored observation is `sign` (1 or -1) times entry j of the observation, with
    /// `inputs[i]` = (j, `sign`), and `actions[a]` is the mirror image of action a.
    ///
    /// # Errors
    /// A sign is not 1 or -1, an index is out of range, or the mirror applied twice changes something.
    pub fn new(inputs: Vec<(u32, f32)>, actions: Vec<u32>) -> Result<Self, MirrorError> {
        let is_restored = |(i, &(from, sign)): (usize, &(u32, f32))| {
            sign.abs() == 1.0 && inputs.get(from as usize) == Some(&(i as u32, sign))
        };
        if let Some(i) = inputs.iter().enumerate().position(|input| !is_restored(input)) {
            return Err(MirrorError::Input(i));
        }
        let is_restored = |(a, &image): (usize, &u32)| actions.get(image as usize) == Some(&(a as u32));
        if let Some(a) = actions.iter().enumerate().position(|action| !is_restored(action)) {
            return Err(MirrorError::Action(a));
        }
        Ok(Self { inputs, actions })
    }

    /// The numbers of inputs and actions.
    #[must_use]
    pub fn size(&self) -> (usize, usize) {
        (self.inputs.len(), self.actions.len())
    }

    /// Mirrors each transition of `batch` with probability 1/2.
    pub(crate) fn augment(&self, batch: &mut Batch, stream: &mut Stream) {
        let width = self.inputs.len();
        let states = batch.states.chunks_exact_mut(width).zip(batch.next_states.chunks_exact_mut(width));
        for ((state, next), action) in states.zip(&mut batch.actions) {
            if random_u64(stream) >> 63 == 1 {
                self.mirror_observation(state);
                self.mirror_observation(next);
                *action = self.actions[usize::from(*action)] as u8;
            }
        }
    }

    /// Mirrors an observation in place: the two entries of a pair are swapped and multiplied by their sign.
    fn mirror_observation(&self, row: &mut [f32]) {
        for (i, &(from, sign)) in self.inputs.iter().enumerate() {
            let from = from as usize;
            if from >= i {
                (row[i], row[from]) = (sign * row[from], sign * row[i]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use wayfield_random::stream;

    use super::*;

    /// Left and right range, bearing, distance; the actions left, ahead, right.
    fn mirror() -> Mirror {
        Mirror::new(vec![(1, 1.0), (0, 1.0), (2, -1.0), (3, 1.0)], vec![2, 1, 0]).expect("an involution")
    }

    /// A batch of the transitions `(state, action, next state)`.
    fn batch(rows: &[([f32; 4], u8, [f32; 4])]) -> Batch {
        Batch {
            states: rows.iter().flat_map(|row| row.0).collect(),
            actions: rows.iter().map(|row| row.1).collect(),
            next_states: rows.iter().flat_map(|row| row.2).collect(),
            returns: vec![3.0; rows.len()],
            discounts: vec![0.5; rows.len()],
            ..Batch::default()
        }
    }

    #[test]
    fn about_half_of_the_transitions_are_mirrored_as_a_whole() {
        let seen = ([1.0, 2.0, 0.3, 4.0], 0, [5.0, 6.0, -0.7, 8.0]);
        let image = ([2.0, 1.0, -0.3, 4.0], 2, [6.0, 5.0, 0.7, 8.0]);
        let mut random = stream(1, "test", 0);
        let mut augmented = batch(&[seen; 1000]);
        mirror().augment(&mut augmented, &mut random);
        let mut mirrored = 0;
        for k in 0..1000 {
            let row = |values: &[f32]| [0, 1, 2, 3].map(|i| values[4 * k + i]);
            let found = (row(&augmented.states), augmented.actions[k], row(&augmented.next_states));
            assert!(found == seen || found == image, "{found:?} is half mirrored");
            mirrored += u32::from(found == image);
        }
        // Four standard deviations of a binomial distribution are 63.
        assert!(mirrored.abs_diff(500) < 64, "{mirrored} of 1000");
        let Batch { returns, discounts, .. } = augmented;
        assert_eq!((returns, discounts), (vec![3.0; 1000], vec![0.5; 1000]));
    }

    #[test]
    fn a_mirror_that_changes_something_when_applied_twice_is_rejected() {
        let rejected = |inputs: &[(u32, f32)], actions: &[u32]| {
            Mirror::new(inputs.to_vec(), actions.to_vec()).expect_err("not a mirror")
        };
        let kept = [(0, 1.0)];
        assert_eq!(
            rejected(&[(1, 1.0), (2, 1.0), (0, 1.0)], &[0]),
            MirrorError::Input(0),
            "a cycle of three"
        );
        assert_eq!(rejected(&[(1, 1.0), (0, -1.0)], &[0]), MirrorError::Input(0), "two signs in a pair");
        assert_eq!(rejected(&[(0, 1.0), (1, 0.5)], &[0]), MirrorError::Input(1), "not a sign");
        assert_eq!(rejected(&[(0, f32::NAN)], &[0]), MirrorError::Input(0), "not a number");
        assert_eq!(rejected(&[(7, 1.0)], &[0]), MirrorError::Input(0), "out of range");
        assert_eq!(rejected(&kept, &[1, 2, 0]), MirrorError::Action(0), "a cycle of three");
        assert_eq!(rejected(&kept, &[0, 0]), MirrorError::Action(1), "two actions with one image");
        assert_eq!(rejected(&kept, &[3]), MirrorError::Action(0), "out of range");
    }
}
