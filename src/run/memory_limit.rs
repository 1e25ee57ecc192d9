//! Checks that a training run fits into the memory limits of the process (`ulimit -v`, `ulimit -d`), as batch systems set them.
//!
//! At such a limit an allocation fails, which aborts a Rust program at once. So an estimate is checked before the start. If an
//! allocation fails nevertheless, the process ends with exit status 1 (`signals/unix.rs`).

use rustix::process::{Resource, getrlimit};

use super::RunError;
use super::evaluate::Evaluator;
use super::folder::RunConfig;
use super::memory::bodies_per_arena;

/// Address space of a thread, in bytes. The allocator reserves 32 MiB or more at a time, most of which is never used.
const THREAD_ADDRESS_SPACE: u64 = 64 << 20;
/// Number of threads besides one per core.
const EXTRA_THREADS: u64 = 4;
/// Address space that a training run needs besides that of its learner, bodies and threads, in bytes.
const BASE_ADDRESS_SPACE: u64 = 384 << 20;
/// Data (`ulimit -d`) that a training run needs besides that of its learner and bodies, in bytes. Includes all threads.
const BASE_DATA: u64 = 128 << 20;
/// The address space that is enough for an evaluation, in bytes. With less, even the first threads may fail to start.
const MIN_ADDRESS_SPACE: u64 = 520 << 20;
/// Memory of a body in the simulation, in bytes.
const BYTES_PER_BODY: u64 = 2048;
/// Copies of the network's parameters: tensors, target network, gradient, moments, policies, a checkpoint in progress.
const PARAMETER_COPIES: u64 = 12;

/// Checks that the process may use the address space that every training run and evaluation needs. Call it before the first
/// thread is started.
///
/// # Errors
/// It may not. The message names the limit, and how much is needed.
pub fn check_start() -> Result<(), RunError> {
    match getrlimit(Resource::As).current {
        Some(limit) if limit < MIN_ADDRESS_SPACE => Err(too_small(limit, "-v", MIN_ADDRESS_SPACE, "")),
        _ => Ok(()),
    }
}

/// Checks that the training run of `config` fits into the memory that the process may use.
///
/// # Errors
/// It does not fit. The message names the limit, the memory needed, and how to raise or reduce them.
pub fn check(config: &RunConfig) -> Result<(), RunError> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from) as u64;
    let threads = (EXTRA_THREADS + cores) * THREAD_ADDRESS_SPACE;
    for (resource, flag, base) in
        [(Resource::As, "-v", BASE_ADDRESS_SPACE + threads), (Resource::Data, "-d", BASE_DATA)]
    {
        let Some(limit) = getrlimit(resource).current else { continue };
        let needed = base + training_bytes(config);
        if limit < needed {
            let or = ", or use a smaller `learning.replay.capacity` or fewer `arenas`";
            return Err(too_small(limit, flag, needed, or));
        }
    }
    Ok(())
}

fn too_small(limit: u64, flag: &str, needed: u64, or: &str) -> RunError {
    RunError::Failed(format!(
        "the memory of this process is limited to {} MB (`ulimit {flag}`), but it needs about {} MB; help: raise the limit{or}",
        limit / 1_000_000,
        needed.div_ceil(1_000_000)
    ))
}

/// Memory of the learner and of all bodies, in training and in evaluations, in bytes. For a set, it is enough for the scenario
/// with the most bodies. Of a level generator, only the first level is counted.
fn training_bytes(config: &RunConfig) -> u64 {
    let (preset, scenario) = (&config.preset, &config.scenario);
    let learning = &preset.learning;
    let inputs = config.observation_layout().width(scenario.lidar.beams);
    // The replay buffer has room for 1/8 more states than transitions.
    let states = preset.stored_states() + learning.replay.capacity / 8;
    // A network that is too large is refused by the learner.
    let shape = learning.network.shape(inputs, preset.actions.len(scenario.robot.motions.len()));
    let parameters = shape.map_or(0, |shape| shape.parameter_count());
    let evaluation_arenas = Evaluator::parallel_arenas(scenario, preset.evaluation.episodes);
    // The scenarios of a set have the same inputs and actions, but not the same walls and obstacles.
    let members = config.scenario_set.iter().flat_map(|set| &set.members);
    let others = members.filter_map(|member| member.source.first().ok());
    let most_bodies =
        others.map(|other| bodies_per_arena(&other)).fold(bodies_per_arena(scenario), usize::max);
    let bodies = most_bodies * (preset.arenas + evaluation_arenas);
    // A state has its values and an 8-byte reference. A transition has up to 24 bytes, and up to four f64 nodes in the sum tree.
    (states * (4 * inputs + 8) + learning.replay.capacity * (24 + 32)) as u64
        + parameters as u64 * 4 * PARAMETER_COPIES
        + bodies as u64 * BYTES_PER_BODY
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::{Scenario, ScenarioSet, SetMember, SetSource};

    #[test]
    fn a_set_needs_the_memory_of_its_scenario_with_the_most_bodies() {
        let small = RunConfig::resolve("scenario-1", "fast", 0).expect("shipped");
        let mut large = small.clone();
        large.scenario.obstacles = vec![small.scenario.obstacles[0].clone(); 1000];
        let member = |scenario: &Scenario| SetMember {
            name: scenario.name.clone(),
            share: 1.0,
            source: SetSource::Scenario(Box::new(scenario.clone())),
        };
        let members = vec![member(&small.scenario), member(&large.scenario)];
        let set = ScenarioSet { name: "both".into(), members };
        let of_set = RunConfig { scenario_set: Some(set), ..small.clone() };
        assert!(training_bytes(&small) < training_bytes(&large));
        assert_eq!(training_bytes(&of_set), training_bytes(&large));
    }
}
