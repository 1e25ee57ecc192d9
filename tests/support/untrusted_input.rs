//! Readers for untrusted files, one per kind. The fuzzers (`fuzz/`) and the tests
//! (`tests/untrusted_input.rs`) use them.
//!
//! In: any bytes. Out: whether they are a valid file. A reader must not panic, take long or use much memory.
//! It uses a valid file as the program would, as far as that is fast, and checks that it is unchanged after
//! being written and read again.

use std::cell::RefCell;
use std::io::Read;
use std::sync::Arc;

use bevy::prelude::{Messages, World};
use wayfield::agent::{ActiveLearner, TrainingFault};
use wayfield::import::{ImportOptions, Imported, barn_path_length_m, import_bytes, import_map};
use wayfield::learning::{Experience, Learner, Mirror, Policy, QNetwork};
use wayfield::random::stream;
use wayfield::reproduce::Experiment;
use wayfield::reproduce::plan::RunPlan;
use wayfield::reproduce::selected::{ExperimentSource, SelectedExperiment};
use wayfield::run::folder::RunConfig;
use wayfield::run::notes::preset_notes;
use wayfield::run::preset::Preset;
use wayfield::run::{checkpoint, evaluate, policy_card, training_setup};
use wayfield::scenario::{
    FileError, LevelGenerator, MAX_FILE_BYTES, Scenario, diagnostics, draw_start_and_goal, notes, parse_ron,
    to_ron, to_text,
};
use wayfield::simulation::{Extensions, Simulation};
use wayfield::task::{EpisodeEnded, ObservationLayout, TaskFault};

/// The file name in error messages.
const NAME: &str = "untrusted.ron";

/// Reads a policy file. Bytes that start with `S` are in a framed form, in which mutations cannot invalidate
/// the length of the header: `S`, two bytes of length, the header, the tensors.
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
    let _ = policy_card::own_scenario(&policy).map_err(|error| error.to_string());
    let _ = policy_card::warning(&policy, &Scenario::default()).map_err(|error| error.to_string());
    let _ = policy_card::note(&policy, &Scenario::default());
    let _ = evaluate::check_compatible(&policy, &Scenario::default(), &ObservationLayout::default())
        .map_err(|error| error.to_string());
    let again = Policy::from_bytes(&policy.to_bytes().expect("finite weights")).expect("a valid policy");
    assert!(again == policy, "writing and reading changes nothing");
    true
}

/// Reads a level generator; if its levels are small, makes one.
pub fn level_generator(bytes: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(bytes) else { return false };
    let generator = match LevelGenerator::parse(text, NAME) {
        Ok(generator) => generator,
        Err(error) => {
            assert!(!error.to_string().is_empty());
            return false;
        }
    };
    let written = to_ron(&generator).expect("RON");
    assert_eq!(parse_ron::<LevelGenerator>(&written, NAME), Ok(generator.clone()));
    if generator.width_m.1 * generator.height_m.1 < 50.0 && generator.gap_m > 0.2 {
        match generator.level(bytes.len() as u64) {
            Ok(level) => assert!(diagnostics(&level).is_empty()),
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    }
    true
}

/// Reads a scenario as for a run; an invalid one as a draft for the editor.
pub fn scenario(bytes: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(bytes) else { return false };
    if let Err(error) = parse_ron::<Scenario>(text, NAME) {
        assert!(!error.to_string().is_empty());
        return false;
    }
    match Scenario::parse(text, NAME) {
        Ok(scenario) => {
            check_round_trip(&scenario, text);
            assert!(notes(&scenario).iter().all(|note| !note.to_string().is_empty()));
            let layout_seed = bytes.len() as u64;
            let generated = scenario.with_generated_obstacles(layout_seed);
            assert!(generated.obstacles.len() <= scenario.max_obstacles());
            // This returns an error if there is no free space for a start and a goal.
            let _ = draw_start_and_goal(&generated, layout_seed, &mut stream(layout_seed, "places", 0));
            true
        }
        Err(error) => {
            assert!(!error.to_string().is_empty());
            if let Ok(draft) = Scenario::parse_draft(text, NAME) {
                check_round_trip(&draft, text);
            }
            false
        }
    }
}

fn check_round_trip(scenario: &Scenario, like: &str) {
    for text in [to_text(scenario, Some(like)), to_text(scenario, None)] {
        // Formatting adds white space, so the text of thousands of obstacles may exceed the limit.
        let too_long = text.len() as u64 > MAX_FILE_BYTES;
        let again = parse_ron::<Scenario>(&text, NAME);
        assert!(too_long || again.as_ref() == Ok(scenario), "writing and reading changes nothing: {text}");
    }
}

/// Imports a map: two bytes with the length of its description, the description, the image.
pub fn map(bytes: &[u8]) -> bool {
    let [low, high, rest @ ..] = bytes else { return false };
    let length = usize::from(u16::from_le_bytes([*low, *high])).min(rest.len());
    let (yaml, image) = rest.split_at(length);
    let Ok(yaml) = std::str::from_utf8(yaml) else { return false };
    is_imported(import_map(yaml, image, "untrusted.yaml".as_ref(), &ImportOptions::default()))
}

/// Imports a world or model in SDF. Models that it includes are not found.
pub fn sdf(bytes: &[u8]) -> bool {
    is_imported(import_bytes("untrusted.sdf".as_ref(), bytes, &ImportOptions::default()))
}

/// Imports the first of the BARN worlds in a JSON file; bytes that are not UTF-8 are read as a path file.
pub fn barn(bytes: &[u8]) -> bool {
    if std::str::from_utf8(bytes).is_err() {
        let length = barn_path_length_m(bytes, "untrusted.npy".as_ref());
        assert!(
            length.as_ref().map_or_else(|error| !error.to_string().is_empty(), |length| length.is_finite())
        );
        return length.is_ok();
    }
    is_imported(import_bytes("untrusted.json".as_ref(), bytes, &ImportOptions::default()))
}

/// Whether a scenario was imported. Asserts that its text is valid and gives the same scenario.
fn is_imported(result: Result<Imported, FileError>) -> bool {
    match result {
        Ok(imported) => {
            let again = Scenario::parse(&imported.text(), NAME);
            assert_eq!(again.as_ref(), Ok(&imported.scenario), "writing and reading changes nothing");
            true
        }
        Err(error) => {
            assert!(!error.to_string().is_empty());
            false
        }
    }
}

/// Reads a preset. If it describes a small learner, creates and trains one.
pub fn preset(bytes: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(bytes) else { return false };
    let preset = match Preset::parse(text, NAME) {
        Ok(preset) => preset,
        Err(error) => {
            assert!(!error.to_string().is_empty());
            return false;
        }
    };
    let again = Preset::parse(&to_ron(&preset).expect("a preset can be written as RON"), NAME);
    assert!(again.as_ref() == Ok(&preset), "writing and reading changes nothing");
    let scenario = Scenario::default();
    for scenario in [None, Some(&scenario)] {
        assert!(preset_notes(&preset, scenario, false).iter().all(|note| !note.to_string().is_empty()));
    }
    let learning = &preset.learning;
    let widths: usize = learning.network.hidden.iter().sum();
    let steps = preset.arenas * (learning.n_step + 1);
    if learning.replay.capacity <= 512 && widths <= 32 && steps <= 64 {
        train_learner(&preset);
    }
    true
}

/// Creates a learner with two inputs and two actions, stores a few transitions, and trains it if that is
/// fast.
fn train_learner(preset: &Preset) {
    let mut learner = Learner::new(&preset.learning, 2, 2, preset.arenas, 1).expect("a valid configuration");
    let mirror = Mirror::new(vec![(1, -1.0), (0, -1.0)], vec![1, 0]).expect("an involution");
    learner.set_mirror(mirror).expect("the same sizes");
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
            // This returns an error if the training diverges.
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

/// Reads an experiment. If it uses only shipped files and few training runs, plans them.
pub fn experiment(bytes: &[u8]) -> bool {
    let Ok(text) = std::str::from_utf8(bytes) else { return false };
    let experiment = match Experiment::parse(text, NAME) {
        Ok(experiment) => experiment,
        Err(error) => {
            assert!(!error.to_string().is_empty());
            return false;
        }
    };
    // Compared as text, because overrides may contain NaN, which planning rejects.
    let written = to_ron(&experiment).expect("an experiment can be written as RON");
    let again = Experiment::parse(&written, NAME).map(|again| to_ron(&again));
    assert!(again == Ok(Ok(written)), "writing and reading changes nothing");
    // Planning loads the scenarios, so only small experiments are planned, and only one in sixteen of those.
    let shipped = |name: &str, known: &[&str]| known.contains(&name);
    let stages = experiment.arms.iter().flat_map(|arm| &arm.stages);
    let known = stages.clone().all(|stage| {
        shipped(&stage.scenario, &["empty", "u-trap"]) && shipped(&stage.preset, &["fast", "dqn", "per_d3qn"])
    }) && experiment.conditions.iter().all(|condition| condition.scenario.is_none());
    let training_runs =
        experiment.seeds.count() as usize * stages.count() * experiment.conditions.len().max(1);
    // Finished runs are read from folders.
    let known = known && experiment.arms.iter().all(|arm| arm.runs.is_empty());
    if known && training_runs <= 6 && crc32c::crc32c(bytes).is_multiple_of(16) {
        let selected = SelectedExperiment {
            figures: (0..experiment.figures.len()).collect(),
            tables: (0..experiment.tables.len()).collect(),
            source: ExperimentSource { from: NAME.into(), experiment },
        };
        // This returns an error if an override does not fit.
        let _ = RunPlan::new(&[selected]).map_err(|error| error.to_string());
    }
    true
}

/// The scenario and the preset of the run whose checkpoints are read here.
const SCENARIO: &str = r#"(
    name: "Untrusted input",
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

/// The run: its configuration and its simulation, which is built once per thread.
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
            commit: None,
            seed: 1,
            scenario_from: NAME.into(),
            preset_from: NAME.into(),
            transfer: None,
            save_policy_after: Vec::new(),
            sensors: Vec::new(),
            reward_terms: Vec::new(),
            scenario_set: None,
            extensions: Extensions::default(),
            scenario,
            preset,
        };
        let learner = Learner::new(&config.preset.learning, 7, 2, 2, 1).expect("a valid configuration");
        let scenario = Arc::new(config.scenario.clone());
        let simulation =
            training_setup::training(&scenario, &config.preset, 1, learner, &Extensions::default());
        Self { config, simulation }
    }
}

thread_local! {
    static RUN: RefCell<Run> = RefCell::new(Run::new());
}

/// Reads a checkpoint in a framed form, in which mutations cannot invalidate lengths and checksums: two
/// lengths of two bytes, the run's head, the learner's head, and the learner's arrays, padded with zeros.
/// From a valid checkpoint the run continues for two control steps.
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
        let (there, _) =
            checkpoint::read_from(&again[..], config).expect("writing and reading changes nothing");
        assert!(there == trainer_state, "writing and reading changes nothing");
        for _ in 0..2 {
            // This returns an error if there is no free space or the training diverges.
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
    checkpoint::write_to(&mut file, world, trainer_state).expect("a vector can be written");
    file
}

/// A valid checkpoint of the run after `steps` control steps, in the framed form.
#[allow(dead_code, reason = "the fuzzers read checkpoints from files")]
pub fn valid_checkpoint(steps: usize) -> Vec<u8> {
    let Run { config, mut simulation } = Run::new();
    let policy = simulation.world().resource::<ActiveLearner>().0.policy();
    let best = checkpoint::BestPolicy {
        success_rate: 0.5,
        mean_time_s: Some(3.0),
        mean_cost_s: 4.0,
        min_cost_s: 4.0,
        bytes: policy.to_bytes().expect("finite weights"),
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
    let number = |at: usize| u64::from_le_bytes(file[at..at + 8].try_into().expect("8 bytes")) as usize;
    let head = &file[24..24 + number(12)];
    let learner = &file[24 + head.len()..];
    let learner_head_length = number(24 + head.len() + 12);
    let learner_head = &learner[20..20 + learner_head_length];
    let arrays = &learner[20 + learner_head_length..learner.len() - 4];
    let lengths = [head.len() as u16, learner_head.len() as u16].map(u16::to_le_bytes).concat();
    [&lengths, head, learner_head, arrays].concat()
}

/// A checkpoint file with valid lengths and checksums around arbitrary bytes.
struct Framed<'a> {
    /// Everything up to the learner's arrays.
    before: Vec<u8>,
    /// The start of the learner's part, which its checksum covers.
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
        let (learner_head, arrays) = rest.split_at(length(1).min(rest.len()));
        let mut before = Vec::with_capacity(64 + head.len() + learner_head.len());
        before.extend_from_slice(b"wayfrun\n");
        before.extend_from_slice(&checkpoint::VERSION.to_le_bytes());
        before.extend_from_slice(&(head.len() as u64).to_le_bytes());
        before.extend_from_slice(&crc32c::crc32c(head).to_le_bytes());
        before.extend_from_slice(head);
        let learner = before.len();
        before.extend_from_slice(b"wayfield");
        before.extend_from_slice(&1_u32.to_le_bytes());
        before.extend_from_slice(&(learner_head.len() as u64).to_le_bytes());
        before.extend_from_slice(learner_head);
        Self { before, learner, read: 0, arrays, crc: 0 }
    }
}

impl Read for Framed<'_> {
    fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
        let left = &self.before[self.read..];
        if left.is_empty() && into.len() == 4 {
            // Only the checksum at the end is read with 4 bytes.
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
