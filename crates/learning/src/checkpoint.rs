//! Checkpoints: everything a learner is, to the bit.
//!
//! In: a learner and a writer, or a reader and the config it was saved with. Out: bytes, or a learner that
//! goes on as if it had never stopped.
//!
//! Layout, little-endian: magic (8 bytes), version (u32), length of the head (u64), the head (postcard:
//! config, counters, streams, weights, moments, chains), the replay buffer's arrays (states, transitions,
//! leaves of the sum tree), CRC-32C of all before it. Lengths of arrays follow from the config and the
//! counters, never from the file alone, and are checked before memory is taken. A checksum tells of accidents, not of
//! intent: so every number is checked, too, before a learner goes on with it.

use std::io::{self, Read, Write};

use serde::{Deserialize, Serialize};

use super::config::{ConfigError, LearningConfig};
use super::learner::{Counters, Learner, Trajectory};
use super::optimizer::OptimizerState;
use super::replay::{Priorities, ReplayBuffer, StateId, StoredTransition};

const MAGIC: &[u8; 8] = b"wayfield";
const VERSION: u32 = 1;

/// The most bytes a head may have: networks are bounded to 2^24 parameters, of which there are four arrays.
const MAX_HEADER_BYTES: u64 = 1 << 29;

/// Why a checkpoint could not be written or read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CheckpointError {
    /// The file could not be written, or read, or ends too early.
    #[error("checkpoint: {0}")]
    Io(#[from] io::Error),
    /// Some other file.
    #[error("not a wayfield checkpoint")]
    NotCheckpoint,
    /// Of another wayfield.
    #[error("checkpoint version {found}, but this wayfield reads version {VERSION}")]
    Version {
        /// The file's version.
        found: u32,
    },
    /// Saved by a learner that learns otherwise.
    #[error("the checkpoint was made with another `{field}`; resume with the config it was made with")]
    ConfigMismatch {
        /// What differs.
        field: &'static str,
    },
    /// What the file says cannot be.
    #[error("the checkpoint is damaged: {0}")]
    Corrupt(&'static str),
    /// The config itself makes no sense.
    #[error(transparent)]
    Config(#[from] ConfigError),
}

/// All but the replay buffer's arrays.
#[derive(Serialize, Deserialize)]
struct Header {
    config: LearningConfig,
    inputs: usize,
    actions: usize,
    counters: Counters,
    online: Vec<f32>,
    target: Vec<f32>,
    optimizer: OptimizerState,
    trajectories: Vec<Trajectory>,
    states: u64,
    first_transition: u64,
    transitions: u64,
    largest_priority: f64,
}

impl Learner {
    /// Writes everything: networks, moments, replay buffer with its priorities, unfinished returns, streams,
    /// counters.
    ///
    /// # Errors
    /// The writer's.
    pub fn save(&self, writer: impl Write) -> Result<(), CheckpointError> {
        let replay = &self.replay;
        let head = Header {
            config: self.config.clone(),
            inputs: self.online.shape().inputs,
            actions: self.online.shape().actions,
            counters: self.counters.clone(),
            online: self.online.parameters().to_vec(),
            target: self.target.parameters().to_vec(),
            optimizer: self.optimizer.clone(),
            trajectories: self.trajectories.clone(),
            states: replay.states.pushed,
            first_transition: replay.head,
            transitions: replay.tail,
            largest_priority: replay.priorities.as_ref().map_or(1.0, |p| p.largest),
        };
        let head = postcard::to_allocvec(&head).map_err(io::Error::other)?;

        let mut out = ChecksummedStream { inner: writer, crc: 0 };
        out.write_all(MAGIC)?;
        out.write_all(&VERSION.to_le_bytes())?;
        out.write_all(&(head.len() as u64).to_le_bytes())?;
        out.write_all(&head)?;
        let states = &replay.states.values[..replay.states.used() * self.online.shape().inputs];
        write_array(&mut out, states.iter().map(|v| v.to_le_bytes()))?;
        write_array(&mut out, replay.transitions.iter().map(|t| t.to_bytes()))?;
        let leaves = (0..replay.transitions.len()).map(|slot| replay.priority(slot).to_le_bytes());
        write_array(&mut out, leaves)?;
        let crc = out.crc;
        out.inner.write_all(&crc.to_le_bytes())?;
        out.inner.flush()?;
        Ok(())
    }

    /// The learner that [`Learner::save`] wrote, made for the same `config` and sizes.
    ///
    /// # Errors
    /// Anything wrong with the file; a damaged one is told by its checksum and never makes this panic.
    pub fn restore(
        config: &LearningConfig,
        inputs: usize,
        actions: usize,
        num_envs: usize,
        reader: impl Read,
    ) -> Result<Self, CheckpointError> {
        let mut learner = Self::new(config, inputs, actions, num_envs, 0)?;
        let mut file = ChecksummedStream { inner: reader, crc: 0 };
        if &file.array::<8>()? != MAGIC {
            return Err(CheckpointError::NotCheckpoint);
        }
        let found = u32::from_le_bytes(file.array()?);
        if found != VERSION {
            return Err(CheckpointError::Version { found });
        }
        let length = u64::from_le_bytes(file.array()?);
        if length > MAX_HEADER_BYTES {
            return Err(CheckpointError::Corrupt("its head is too long"));
        }
        let mut bytes = Vec::new();
        (&mut file).take(length).read_to_end(&mut bytes)?;
        let head: Header = postcard::from_bytes(&bytes).map_err(|_| CheckpointError::Corrupt("its head"))?;
        head.check(&learner)?;

        learner.replay.read(&head, inputs, actions, &mut file)?;
        let (crc, stored) = (file.crc, u32::from_le_bytes(file.array()?));
        if crc != stored {
            return Err(CheckpointError::Corrupt("its checksum does not agree"));
        }
        learner.online.update(|weights| weights.copy_from_slice(&head.online));
        learner.target.update(|weights| weights.copy_from_slice(&head.target));
        learner.optimizer = head.optimizer;
        learner.trajectories = head.trajectories;
        learner.counters = head.counters;
        learner.largest_reward =
            learner.replay.transitions.iter().fold(0.0, |largest, t| largest.max(t.reward.abs()));
        Ok(learner)
    }
}

impl Header {
    /// Agrees with a fresh learner of the config asked for, in all lengths.
    fn check(&self, learner: &Learner) -> Result<(), CheckpointError> {
        let shape = learner.online.shape();
        for (field, same) in [
            ("learning", self.config == learner.config),
            ("observation", self.inputs == shape.inputs),
            ("actions", self.actions == shape.actions),
            ("arenas", self.trajectories.len() == learner.trajectories.len()),
        ] {
            if !same {
                return Err(CheckpointError::ConfigMismatch { field });
            }
        }
        let parameters = learner.online.parameters().len();
        let kept = self.transitions.checked_sub(self.first_transition);
        let kept = kept.filter(|&n| n <= learner.replay.capacity() as u64);
        let pending = |trajectory: &Trajectory| {
            let n_step = trajectory.n_step.pending();
            let was_seen = |id: StateId| id.0 < self.states;
            n_step.len() < self.config.n_step
                && trajectory.last.is_none_or(was_seen)
                && n_step.iter().all(|p| {
                    usize::from(p.action) < self.actions && was_seen(p.state) && p.reward.is_finite()
                })
        };
        let finite = |values: &[f32]| values.iter().all(|value| value.is_finite());
        let Counters { env_steps, episodes, gradient_steps, pending_updates, epsilon_start, sampling } =
            &self.counters;
        // What the env steps brought at most, of which as many are there to be drawn; and something must be.
        let remembered = kept.unwrap_or_default().max(learner.trajectories.len() as u64);
        let max_pending_updates = remembered * u64::from(self.config.gradient_steps);
        let can_be_paid = *pending_updates == 0 || kept.is_some_and(|n| n > 0);
        let counts =
            [self.states, self.transitions, *env_steps, *episodes, *gradient_steps, self.optimizer.steps];
        let OptimizerState { first, second, steps: _ } = &self.optimizer;
        for (what, sane) in [
            ("its weights", self.online.len() == parameters && self.target.len() == parameters),
            ("a weight is not finite", finite(&self.online) && finite(&self.target)),
            ("its moments", first.len() == learner.optimizer.first.len() && second.len() == parameters),
            ("a moment cannot be", finite(first) && second.iter().all(|m| m.is_finite() && *m >= 0.0)),
            ("its transitions' count", kept.is_some()),
            ("its counters", counts.iter().all(|&count| count < 1 << 62)),
            ("its gradient steps owed", u64::from(*pending_updates) <= max_pending_updates && can_be_paid),
            ("its epsilon", epsilon_start.is_none_or(|epsilon| (0.0..=1.0).contains(&epsilon))),
            ("its stream", wayfield_random::is_valid(sampling)),
            ("its priorities", is_priority(self.largest_priority)),
            ("its chains", self.trajectories.iter().all(pending)),
        ] {
            if !sane {
                return Err(CheckpointError::Corrupt(what));
            }
        }
        Ok(())
    }
}

impl ReplayBuffer {
    /// Reads the arrays into an empty buffer.
    fn read(
        &mut self,
        head: &Header,
        inputs: usize,
        actions: usize,
        file: &mut ChecksummedStream<impl Read>,
    ) -> Result<(), CheckpointError> {
        self.states.pushed = head.states;
        (self.head, self.tail) = (head.first_transition, head.transitions);
        let used = self.states.used();
        let mut values = self.states.values.iter_mut();
        read_array(file, used * inputs, |bytes| {
            if let Some(value) = values.next() {
                *value = f32::from_le_bytes(bytes);
            }
        })?;
        let slots = self.tail.min(self.capacity() as u64) as usize;
        read_array(file, slots, |bytes| self.transitions.push(StoredTransition::from_bytes(bytes)))?;
        if !self.states.values[..used * inputs].iter().all(|value| value.is_finite()) {
            return Err(CheckpointError::Corrupt("an observation is not finite"));
        }
        if self.transitions.iter().any(|t| !t.exists(used, actions)) {
            return Err(CheckpointError::Corrupt("a transition refers to nothing"));
        }
        if !self.transitions.iter().all(StoredTransition::is_valid) {
            return Err(CheckpointError::Corrupt("a transition's reward or discount cannot be"));
        }
        let mut leaves = Vec::new();
        read_array(file, slots, |bytes| leaves.push(f64::from_le_bytes(bytes)))?;
        // Which transition last refers to a state follows from the transitions kept; those gone do not
        // matter.
        for number in self.head..self.tail {
            let slot = self.slot(number);
            let StoredTransition { state, next, .. } = self.transitions[slot];
            for state in [state, next] {
                self.states.last_reference[state as usize] = number + 1;
            }
            if !is_priority(leaves[slot]) {
                return Err(CheckpointError::Corrupt("a priority is not above 0"));
            }
        }
        // What is gone must never be drawn.
        let mut gone = (self.tail - slots as u64..self.head).map(|number| self.slot(number));
        if self.priorities.is_some() && gone.any(|slot| leaves[slot] != 0.0) {
            return Err(CheckpointError::Corrupt("a priority of a transition that is gone is not 0"));
        }
        if let Some(Priorities { tree, largest }) = &mut self.priorities {
            tree.set_all(leaves.into_iter());
            *largest = head.largest_priority;
        }
        Ok(())
    }
}

/// Whether the power of an error can be so large: finite as an f32, so that no sum of them is infinite.
fn is_priority(priority: f64) -> bool {
    priority > 0.0 && priority <= f64::from(f32::MAX)
}

impl StoredTransition {
    /// Whether its numbers are such as [`ReplayBuffer::push`] stores.
    fn is_valid(&self) -> bool {
        self.reward.is_finite() && (0.0..=1.0).contains(&self.discount) && self.flags < 4
    }

    /// Whether its states and its action are such as there are.
    fn exists(&self, states: usize, actions: usize) -> bool {
        (self.state.max(self.next) as usize) < states && usize::from(self.action) < actions
    }

    fn to_bytes(self) -> [u8; 18] {
        let mut bytes = [0; 18];
        bytes[0..4].copy_from_slice(&self.state.to_le_bytes());
        bytes[4..8].copy_from_slice(&self.next.to_le_bytes());
        bytes[8..12].copy_from_slice(&self.reward.to_le_bytes());
        bytes[12..16].copy_from_slice(&self.discount.to_le_bytes());
        bytes[16] = self.action;
        bytes[17] = self.flags;
        bytes
    }

    fn from_bytes(bytes: [u8; 18]) -> Self {
        let four = |at: usize| [bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]];
        Self {
            state: u32::from_le_bytes(four(0)),
            next: u32::from_le_bytes(four(4)),
            reward: f32::from_le_bytes(four(8)),
            discount: f32::from_le_bytes(four(12)),
            action: bytes[16],
            flags: bytes[17],
        }
    }
}

/// Writes elements of N bytes, in pieces large enough for any writer.
fn write_array<const N: usize>(
    out: &mut impl Write,
    elements: impl Iterator<Item = [u8; N]>,
) -> io::Result<()> {
    let mut piece = Vec::with_capacity(PIECE + N);
    for element in elements {
        piece.extend_from_slice(&element);
        if piece.len() >= PIECE {
            out.write_all(&piece)?;
            piece.clear();
        }
    }
    out.write_all(&piece)
}

/// Reads `count` elements of N bytes, likewise in pieces.
fn read_array<const N: usize>(
    file: &mut impl Read,
    count: usize,
    mut each: impl FnMut([u8; N]),
) -> io::Result<()> {
    let mut piece = vec![0; PIECE / N * N];
    let mut left = count * N;
    while left > 0 {
        let bytes = left.min(piece.len());
        file.read_exact(&mut piece[..bytes])?;
        piece[..bytes].as_chunks().0.iter().for_each(|&element| each(element));
        left -= bytes;
    }
    Ok(())
}

/// How many bytes are read or written at once.
const PIECE: usize = 1 << 16;

/// A reader or writer that keeps the CRC-32C of all that has passed.
struct ChecksummedStream<T> {
    inner: T,
    crc: u32,
}

impl<T: Write> Write for ChecksummedStream<T> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let n = self.inner.write(bytes)?;
        self.crc = crc32c::crc32c_append(self.crc, &bytes[..n]);
        Ok(n)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

impl<T: Read> Read for ChecksummedStream<T> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let n = self.inner.read(bytes)?;
        self.crc = crc32c::crc32c_append(self.crc, &bytes[..n]);
        Ok(n)
    }
}

impl<T: Read> ChecksummedStream<T> {
    fn array<const N: usize>(&mut self) -> io::Result<[u8; N]> {
        let mut bytes = [0; N];
        self.read_exact(&mut bytes)?;
        Ok(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{NetworkConfig, Optimizer, ReplayConfig, Sampling, Schedule};
    use crate::learner::Experience;
    use crate::n_step::{PendingStep, StepEnd};
    use wayfield_random::Stream;

    /// A learner whose rings have gone round, and the config it was made with.
    fn learner() -> (LearningConfig, Learner) {
        let beta = Schedule::Constant(0.4);
        let sampling = Sampling::Prioritized { alpha: 0.6, beta, importance_weights: true, epsilon: 0.01 };
        let config = LearningConfig {
            network: NetworkConfig { hidden: vec![3], dueling: true },
            n_step: 3,
            batch_size: 2,
            optimizer: Optimizer::Adam { beta1: 0.9, beta2: 0.999, epsilon: 1e-8 },
            replay: ReplayConfig { capacity: 8, learning_starts: 0, sampling },
            ..LearningConfig::default()
        };
        let mut learner = Learner::new(&config, 2, 2, 1, 1).expect("it makes sense");
        for step in 0..30 {
            learner.store(&Experience {
                env_index: 0,
                observation: &[step as f32, 0.0],
                action: step % 2,
                reward: 1.0,
                next_observation: &[step as f32 + 1.0, 0.0],
                terminated: step % 9 == 8,
                truncated: false,
            });
            learner.train().expect("it does not diverge");
        }
        (config, learner)
    }

    fn restored(config: &LearningConfig, learner: &Learner) -> Result<Learner, CheckpointError> {
        let mut bytes = Vec::new();
        learner.save(&mut bytes).expect("memory can be written");
        Learner::restore(config, 2, 2, 1, &bytes[..])
    }

    /// What is changed in a learner that was saved, and what its file must be refused for.
    type Breakage = (&'static str, fn(&mut Learner));

    #[test]
    fn numbers_that_no_learner_has_are_refused_whatever_the_checksum_says() {
        let (config, sound) = learner();
        let mut again = restored(&config, &sound).expect("it is sound");
        assert_eq!(again.counters, sound.counters);
        again.train().expect("it goes on");
        let breakages: &[Breakage] = &[
            ("a weight is not finite", |l| l.online.update(|weights| weights[3] = f32::NAN)),
            ("a weight is not finite", |l| l.target.update(|weights| weights[0] = f32::INFINITY)),
            ("its moments", |l| l.optimizer.second.truncate(2)),
            ("a moment cannot be", |l| l.optimizer.first[1] = f32::NAN),
            ("a moment cannot be", |l| l.optimizer.second[1] = -1.0),
            ("its counters", |l| l.optimizer.steps = u64::MAX),
            ("its counters", |l| l.counters.env_steps = u64::MAX),
            ("its counters", |l| l.counters.episodes = u64::MAX),
            ("its gradient steps owed", |l| l.counters.pending_updates = u32::MAX),
            ("its epsilon", |l| l.counters.epsilon_start = Some(f32::NAN)),
            ("its stream", |l| {
                let zero = postcard::to_allocvec(&0_u128).expect("a number");
                l.counters.sampling = postcard::from_bytes::<Stream>(&zero).expect("a state");
            }),
            ("its priorities", |l| {
                if let Some(priorities) = &mut l.replay.priorities {
                    priorities.largest = 1e300;
                }
            }),
            ("its chains", |l| l.trajectories[0].last = Some(StateId(1 << 40))),
            ("its chains", |l| {
                let step = PendingStep { state: StateId(1 << 40), action: 0, reward: 0.0 };
                l.trajectories[0].n_step.push(step, StateId(0), StepEnd::Ongoing, (9, 0.9), |_| ());
            }),
            ("an observation is not finite", |l| l.replay.states.values[3] = f32::NAN),
            ("a transition refers to nothing", |l| l.replay.transitions[2].next = u32::MAX),
            ("a transition refers to nothing", |l| l.replay.transitions[2].action = 2),
            ("a transition's reward or discount cannot be", |l| l.replay.transitions[1].reward = f32::NAN),
            ("a transition's reward or discount cannot be", |l| l.replay.transitions[1].discount = 1.5),
            ("a priority is not above 0", |l| set_priority(l, |head, _| head, f64::INFINITY)),
            ("a priority is not above 0", |l| set_priority(l, |_, tail| tail - 1, 0.0)),
            ("a priority of a transition that is gone is not 0", |l| {
                l.replay.head += 1;
            }),
        ];
        for (what, breakage) in breakages {
            let mut broken = sound.clone();
            breakage(&mut broken);
            match restored(&config, &broken) {
                Err(CheckpointError::Corrupt(why)) => assert_eq!(why, *what),
                other => panic!("{what}: {:?}", other.map(|_| ())),
            }
        }
    }

    /// Gives a transition of those kept the priority `weight`.
    fn set_priority(learner: &mut Learner, which: fn(u64, u64) -> u64, weight: f64) {
        let slot = learner.replay.slot(which(learner.replay.head, learner.replay.tail));
        if let Some(priorities) = &mut learner.replay.priorities {
            priorities.tree.set(slot, weight);
        }
    }
}
