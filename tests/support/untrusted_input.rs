//! What is done with a file from a stranger: for each kind what a user's program would do with it, as far as it takes no
//! time. The fuzzers (`fuzz/`) and the tests (`tests/untrusted_input.rs`) go through these functions.
//!
//! In: any bytes. Out: nothing, or whether they were a sound file; what must never come is a panic, a long wait, or a lot
//! of memory. Where a file is sound, what was read of it must be worth something: it is written and read again, and used.

use std::cell::RefCell;
use std::io::Read;
use std::sync::Arc;

use bevy::prelude::{Messages, World};
use wayfield::agent::{ActiveLearner, TrainingFault};
use wayfield::learning::{Experience, Learner, Policy, QNetwork};
use wayfield::random::stream;
use wayfield::reproduce::Experiment;
use wayfield::reproduce::plan::{ExperimentSource, RunPlan, SelectedExperiment};
use wayfield::run::folder::RunConfig;
use wayfield::run::preset::Preset;
use wayfield::run::{checkpoint, evaluate, policy_card, training_setup};
use wayfield::scenario::{MAX_FILE_BYTES, Scenario, draw_start_and_goal, parse_ron, to_ron, to_text};
use wayfield::simulation::{Extensions, Simulation};
use wayfield::task::{EpisodeEnded, ObservationLayout, TaskFault};

/// The name that errors give the file.
const NAME: &str = "stranger.ron";

/// A policy's file. Where it begins with `S`, the length of its header, which mutations spoil at once, is put right: `S`,
/// two bytes of length, the header, the tensors.
pub fn policy(bytes: &[u8]) -> bool {
    let file = match bytes {
        [b'S', low, high, rest @ ..] => {
            let length = usize::from(u16::from_le_bytes([*low, *high])).min(rest.len());
            let (header, tensors) = rest.split_at(length);
            [&(length as u64).to_le_bytes()[..], header, tensors].concat()
        }
        _ => bytes.to_vec(),
    };
    let policy = match Policy::from_bytes(&file) {
        Ok(policy) => policy,
        Err(error) => {
            assert!(!error.to_string().is_empty());
            return false;
        }
    };
    let network = QNetwork::from_policy(&policy).expect("a policy's shape is valid");
    let shape = network.shape();
    let observations: Vec<f32> = (0..2 * shape.inputs).map(|k| k as f32 * 0.1).collect();
    let (mut q, mut parts) = (Vec::new(), Vec::new());
    network.q_values(&observations, 2, &mut q);
    network.value_and_advantage(&observations, 2, &mut parts);
    assert_eq!((q.len(), parts.len()), (2 * shape.actions, 2 * (shape.actions + 1)));
    let _ = policy_card::encoding(&policy).map_err(|error| error.to_string());
    let _ = evaluate::check_compatible(&policy, &Scenario::default(), &ObservationLayout::default())
        .map_err(|error| error.to_string());
    let again =
        Policy::from_bytes(&policy.to_bytes().expect("its weights are finite")).expect("it was written");
    assert!(again == policy, "what is written is read back");
    true
}

/// The text of a scenario's file: as it is run, and as it is edited.
pub fn scenario(bytes: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(bytes) else { return false };
    if let Err(error) = parse_ron::<Scenario>(text, NAME) {
        assert!(!error.to_string().is_empty());
        return false;
    }
    match Scenario::parse(text, NAME) {
        Ok(scenario) => {
            written_and_read(&scenario, text);
            let layout_seed = bytes.len() as u64;
            let room = scenario.with_generated_obstacles(layout_seed);
            assert!(room.obstacles.len() <= scenario.max_obstacles());
            // There may be none at this moment; then it says so.
            let _ = draw_start_and_goal(&room, layout_seed, &mut stream(layout_seed, "places", 0));
            true
        }
        Err(error) => {
            assert!(!error.to_string().is_empty());
            if let Ok(draft) = Scenario::parse_draft(text, NAME) {
                written_and_read(&draft, text);
            }
            false
        }
    }
}

fn written_and_read(scenario: &Scenario, like: &str) {
    for text in [to_text(scenario, Some(like)), to_text(scenario, None)] {
        // (Thousands of obstacles without a space between them take more bytes when they are written in order.)
        let too_long = text.len() as u64 > MAX_FILE_BYTES;
        let again = parse_ron::<Scenario>(&text, NAME);
        assert!(too_long || again.as_ref() == Ok(scenario), "what is written is read back: {text}");
    }
}

/// The text of a preset's file; where what it asks for is small, a learner is made and fed.
pub fn preset(bytes: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(bytes) else { return false };
    let preset = match Preset::parse(text, NAME) {
        Ok(preset) => preset,
        Err(error) => {
            assert!(!error.to_string().is_empty());
            return false;
        }
    };
    let again = Preset::parse(&to_ron(&preset).expect("a preset is RON"), NAME);
    assert!(again.as_ref() == Ok(&preset), "what is written is read back");
    let learning = &preset.learning;
    let widths: usize = learning.network.hidden.iter().sum();
    let steps = preset.arenas * (learning.n_step + 1);
    if learning.replay.capacity <= 512 && widths <= 32 && steps <= 64 {
        fed(&preset);
    }
    true
}

/// A learner for observations of two numbers and two actions, that remembers a few steps, and learns if it soon can.
fn fed(preset: &Preset) {
    let mut learner = Learner::new(&preset.learning, 2, 2, preset.arenas, 1).expect("it was checked");
    for step in 0..12 {
        for env_index in 0..preset.arenas {
            learner.store(&Experience {
                env_index,
                observation: &[step as f32, 0.5],
                action: step % 2,
                reward: 1.0,
                next_observation: &[step as f32 + 1.0, 0.5],
                terminated: step % 5 == 4,
                truncated: step % 7 == 6,
            });
        }
        if step % 5 == 4 {
            learner.episode_ended();
        }
        assert!((0.0..=1.0).contains(&learner.epsilon()));
        if learner.config().batch_size <= 16 && learner.pending_updates() <= 2 {
            // It may diverge; then it says so.
            let _ = learner.train().map_err(|diverged| diverged.to_string());
        }
    }
    let q = |network: &QNetwork| {
        let mut q = Vec::new();
        network.q_values(&[0.1, 0.2], 1, &mut q);
        q.len()
    };
    assert_eq!((q(learner.network()), q(learner.target_network())), (2, 2));
}

/// The text of an experiment's file; where it names what is shipped and asks for few trainings, they are planned.
pub fn experiment(bytes: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(bytes) else { return false };
    let experiment = match Experiment::parse(text, NAME) {
        Ok(experiment) => experiment,
        Err(error) => {
            assert!(!error.to_string().is_empty());
            return false;
        }
    };
    // (By its text: what it changes may be no number, which is told when it is planned.)
    let written = to_ron(&experiment).expect("an experiment is RON");
    let again = Experiment::parse(&written, NAME).map(|again| to_ron(&again));
    assert!(again == Ok(Ok(written)), "what is written is read back");
    // Planning reads the scenarios: those of the smallest, now and then.
    let shipped = |name: &str, known: &[&str]| known.contains(&name);
    let stages = experiment.arms.iter().flat_map(|arm| &arm.stages);
    let known = stages.clone().all(|stage| {
        shipped(&stage.scenario, &["empty", "u-trap"])
            && shipped(&stage.preset, &["fast", "dqn", "per_d3qn"])
            && stage.overrides.scenario.is_none()
    }) && experiment.conditions.iter().all(|condition| condition.overrides.scenario.is_none());
    let trainings = experiment.seeds as usize * stages.count() * experiment.conditions.len().max(1);
    if known && trainings <= 6 && crc32c::crc32c(bytes).is_multiple_of(16) {
        let selected = SelectedExperiment {
            figures: (0..experiment.figures.len()).collect(),
            tables: (0..experiment.tables.len()).collect(),
            source: ExperimentSource { from: NAME.into(), experiment },
        };
        // What it changes may not fit; then it says so.
        let _ = RunPlan::new(&[selected]).map_err(|error| error.to_string());
    }
    true
}

/// What a run of two arenas is told whose checkpoint is read here.
const SCENARIO: &str = r#"(
    name: "Strangers",
    enclosure: Rectangle(width_m: 3.0, height_m: 3.0),
    obstacles: [(shape: Circle(radius_m: 0.1), position_m: (0.8, 0.0), motion: Orbit(centre_m: (0.0, 0.0), speed_rad_s: 0.5))],
    generators: [(count: 1, shape: Rectangle(width_m: (0.1, 0.2), height_m: (0.1, 0.2)), gap_m: 0.3)],
    robot: (motions: [(v_m_s: 0.15, w_rad_s: 1.5), (v_m_s: 0.15, w_rad_s: 0.0)], actuator_lag_s: 0.1),
    lidar: (beams: 3, noise_std_m: 0.01, dropout: 0.1, latency_steps: 1),
    task: (max_episode_steps: 20),
    benchmark_route: (start_m: (-1.0, -1.0), goal_m: (1.2, 1.2)),
)"#;
const PRESET: &str = "(
    arenas: 2,
    budget: EnvSteps(1000000),
    learning: (
        network: (hidden: [3], dueling: true),
        double: true, gamma: 0.9, n_step: 2, reward_scale: 0.01, loss: Huber(delta: 1.0),
        optimizer: Adam(beta1: 0.9, beta2: 0.99, epsilon: 1e-8),
        learning_rate: Constant(0.001), batch_size: 4,
        replay: (capacity: 12, learning_starts: 0, sampling: Prioritized(alpha: 0.6, beta: Constant(0.4), \
            importance_weights: true, epsilon: 0.01)),
        train_freq: 2, gradient_steps: 1, target_update: Hard(every: 3),
        exploration: PerEpisode(start: 1.0, decay: 0.9, end: 0.1),
    ),
)";

/// That run: its configuration, and its world, which is made once.
struct Run {
    config: RunConfig,
    simulation: Simulation,
}

impl Run {
    fn new() -> Self {
        let scenario = Scenario::parse(SCENARIO, NAME).unwrap_or_else(|error| panic!("{error}"));
        let preset = Preset::parse(PRESET, NAME).unwrap_or_else(|error| panic!("{error}"));
        let config = RunConfig {
            version: String::new(),
            seed: 1,
            scenario_from: NAME.into(),
            preset_from: NAME.into(),
            transfer: None,
            save_policy_after_episodes: Vec::new(),
            sensors: Vec::new(),
            reward_terms: Vec::new(),
            extensions: Extensions::default(),
            scenario,
            preset,
        };
        let learner = Learner::new(&config.preset.learning, 7, 2, 2, 1).expect("it was checked");
        let scenario = Arc::new(config.scenario.clone());
        let simulation =
            training_setup::training(&scenario, &config.preset, 1, learner, &Extensions::default());
        Self { config, simulation }
    }
}

thread_local! {
    static RUN: RefCell<Run> = RefCell::new(Run::new());
}

/// A checkpoint, without what mutations spoil at once: two bytes of length, two more, the head of the run's part and the
/// head of the learner's, which are so long, and the learner's arrays. What is missing of those is taken to be zeros.
/// Where it is sound, the run goes on from there for two steps.
pub fn checkpoint(bytes: &[u8]) -> bool {
    RUN.with_borrow_mut(|Run { config, simulation }| {
        let (trainer_state, learner) = match checkpoint::read_from(Framed::new(bytes), config) {
            Ok(read) => read,
            Err(error) => {
                assert!(!error.is_empty());
                return false;
            }
        };
        let world = simulation.world_mut();
        world.insert_resource(ActiveLearner(learner));
        world.insert_resource(TaskFault::default());
        world.insert_resource(TrainingFault::default());
        checkpoint::restore(world, &trainer_state);
        let again = written(world, &mut trainer_state.clone());
        let (there, _) = checkpoint::read_from(&again[..], config).expect("what is written is read back");
        assert!(there == trainer_state, "to the bit");
        for _ in 0..2 {
            // No place may be found, or it may diverge; then it says so.
            if wayfield::simulation::step(world).map_err(|error| error.to_string()).is_err() {
                break;
            }
        }
        world.resource_mut::<Messages<EpisodeEnded>>().clear();
        true
    })
}

fn written(world: &mut World, trainer_state: &mut checkpoint::TrainerState) -> Vec<u8> {
    let mut file = Vec::new();
    checkpoint::write_to(&mut file, world, trainer_state).expect("memory can be written");
    file
}

/// What [`checkpoint`] takes as a sound one: of the run after `steps` control steps.
#[allow(dead_code, reason = "the fuzzers have theirs from a file")]
pub fn valid_checkpoint(steps: usize) -> Vec<u8> {
    let Run { config, mut simulation } = Run::new();
    let policy = simulation.world().resource::<ActiveLearner>().0.policy();
    let best = checkpoint::BestPolicy {
        success_rate: 0.5,
        mean_time_s: Some(3.0),
        mean_cost_s: 4.0,
        min_cost_s: 4.0,
        bytes: policy.to_bytes().expect("its weights are finite"),
    };
    let mut trainer_state = checkpoint::TrainerState {
        best: Some(best),
        recent_returns: [1.0, -2.0].into(),
        means: Some((0.1, 0.2, 0.3)),
        last_success_rate: Some(0.5),
        next_evaluation: config.preset.evaluation.every_env_steps,
        ..Default::default()
    };
    for _ in 0..steps {
        simulation.step().unwrap_or_else(|error| panic!("{error}"));
    }
    let file = written(simulation.world_mut(), &mut trainer_state);
    let number = |at: usize| u64::from_le_bytes(file[at..at + 8].try_into().expect("eight bytes")) as usize;
    let head = &file[24..24 + number(12)];
    let learner = &file[24 + head.len()..];
    let its_length = number(24 + head.len() + 12);
    let its_head = &learner[20..20 + its_length];
    let arrays = &learner[20 + its_length..learner.len() - 4];
    let lengths = [head.len() as u16, its_head.len() as u16].map(u16::to_le_bytes).concat();
    [&lengths, head, its_head, arrays].concat()
}

/// The file of a checkpoint in which lengths and checksums are right whatever the bytes are.
struct Framed<'a> {
    /// Everything up to the learner's arrays.
    before: Vec<u8>,
    /// Where the learner's part begins, over which its checksum goes.
    learner: usize,
    read: usize,
    arrays: &'a [u8],
    crc: u32,
}

impl<'a> Framed<'a> {
    fn new(bytes: &'a [u8]) -> Self {
        let (lengths, rest) = bytes.split_at(bytes.len().min(4));
        let length = |k: usize| {
            let byte = |k: usize| lengths.get(k).copied().unwrap_or_default();
            usize::from(u16::from_le_bytes([byte(2 * k), byte(2 * k + 1)]))
        };
        let (head, rest) = rest.split_at(length(0).min(rest.len()));
        let (its_head, arrays) = rest.split_at(length(1).min(rest.len()));
        let mut before = Vec::with_capacity(64 + head.len() + its_head.len());
        before.extend_from_slice(b"wayfrun\n");
        before.extend_from_slice(&3_u32.to_le_bytes());
        before.extend_from_slice(&(head.len() as u64).to_le_bytes());
        before.extend_from_slice(&crc32c::crc32c(head).to_le_bytes());
        before.extend_from_slice(head);
        let learner = before.len();
        before.extend_from_slice(b"wayfield");
        before.extend_from_slice(&1_u32.to_le_bytes());
        before.extend_from_slice(&(its_head.len() as u64).to_le_bytes());
        before.extend_from_slice(its_head);
        Self { before, learner, read: 0, arrays, crc: 0 }
    }
}

impl Read for Framed<'_> {
    fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
        let left = &self.before[self.read..];
        if left.is_empty() && into.len() == 4 {
            // Only the checksum at the end is so short.
            into.copy_from_slice(&self.crc.to_le_bytes());
            return Ok(4);
        }
        let count = if left.is_empty() { into.len() } else { left.len().min(into.len()) };
        if left.is_empty() {
            let (some, rest) = self.arrays.split_at(self.arrays.len().min(count));
            into[..some.len()].copy_from_slice(some);
            into[some.len()..count].fill(0);
            self.arrays = rest;
        } else {
            into[..count].copy_from_slice(&left[..count]);
        }
        let learner = self.learner.saturating_sub(self.read).min(count);
        self.crc = crc32c::crc32c_append(self.crc, &into[learner..count]);
        self.read = (self.read + count).min(self.before.len());
        Ok(count)
    }
}
