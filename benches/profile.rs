//! Where a control step goes: the time of each of its sets.
//!
//! `cargo bench --no-default-features --bench profile` prints nanoseconds per env step in Scenario I, medians over control
//! steps, per number of arenas: without gradient steps, and last the default preset as it trains. A clock is read between two sets,
//! which costs some 25 ns each: it shows at one arena only.

use std::error::Error;
use std::sync::Arc;
use std::time::Instant;

use bevy::prelude::*;
use wayfield::control_step::{ControlSet, ControlStep};
use wayfield::learning::Learner;
use wayfield::run::{shipped, simulation};
use wayfield::task::observation;

const SETS: [ControlSet; 8] = [
    ControlSet::Decide,
    ControlSet::Actuate,
    ControlSet::Simulate,
    ControlSet::Sense,
    ControlSet::Judge,
    ControlSet::Remember,
    ControlSet::Learn,
    ControlSet::Restart,
];
const ARENAS: [usize; 6] = [1, 16, 64, 256, 512, 1024];
const ENV_STEPS: usize = 200_000;

/// When each set ended, in this control step.
#[derive(Resource, Default)]
struct Ends(Vec<Instant>);

/// The binary's.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> Result<(), Box<dyn Error>> {
    let names: Vec<String> = SETS.iter().map(|set| format!("{set:?}")).collect();
    println!("| arenas | {} | whole |", names.join(" | "));
    println!("|---|{}---|", "---|".repeat(SETS.len()));
    for arenas in ARENAS {
        row(&arenas.to_string(), arenas, false)?;
    }
    row(&format!("{}, learning", shipped::preset("fast")?.arenas), shipped::preset("fast")?.arenas, true)
}

fn row(name: &str, arenas: usize, learning: bool) -> Result<(), Box<dyn Error>> {
    let scenario = Arc::new(shipped::scenario("scenario-1")?);
    let mut preset = shipped::preset("fast")?;
    preset.arenas = arenas;
    if !learning {
        preset.learning.train_interval = u64::MAX;
    }
    let inputs = observation::width(scenario.lidar.beams);
    let learner = Learner::new(&preset.learning, inputs, scenario.robot.motions.len(), arenas, 1)?;
    let mut app = simulation::training(&scenario, &preset, 1, learner);
    app.init_resource::<Ends>();
    for set in &SETS[..SETS.len() - 1] {
        let next = SETS[SETS.iter().position(|other| other == set).unwrap_or(0) + 1].clone();
        app.add_systems(ControlStep, tick.after(set.clone()).before(next));
    }
    let world = app.world_mut();
    // Past the start, where learning waits for its first transitions.
    for _ in 0..(4_000 / arenas).max(4) {
        world.resource_mut::<Ends>().0.clear();
        simulation::step(world)?;
    }
    let mut times = vec![Vec::new(); SETS.len() + 1];
    for _ in 0..ENV_STEPS / arenas / if learning { 4 } else { 1 } {
        world.resource_mut::<Ends>().0.clear();
        let began = Instant::now();
        simulation::step(world)?;
        let ended = Instant::now();
        let mut from = began;
        for (set, end) in world.resource::<Ends>().0.iter().chain([&ended]).enumerate() {
            times[set].push((*end - from).as_nanos() as usize / arenas);
            from = *end;
        }
        times[SETS.len()].push((ended - began).as_nanos() as usize / arenas);
    }
    let medians: Vec<String> = times
        .iter_mut()
        .map(|of_set| {
            of_set.sort_unstable();
            of_set.get(of_set.len() / 2).map_or(String::new(), usize::to_string)
        })
        .collect();
    println!("| {name} | {} |", medians.join(" | "));
    Ok(())
}

fn tick(mut ends: ResMut<Ends>) {
    ends.0.push(Instant::now());
}
