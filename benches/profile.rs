//! Where a control step goes: the time of each of its sets.
//!
//! `cargo bench --no-default-features --bench profile` prints nanoseconds per env step in Scenario I, means over control
//! steps that see episodes at all ages, per number of arenas: without gradient steps, and last the default preset as it
//! trains. Between two sets a system reads the clock, which costs some 40 ns: it shows at one arena only. `Decide` begins
//! with the schedule, `Reset` ends with the look at the faults.

#[path = "support/allocator.rs"]
mod allocator;
#[path = "support/training_app.rs"]
mod training_app;

use std::error::Error;
use std::time::{Duration, Instant};

use bevy::prelude::*;
use wayfield::control_step::{ControlSet, ControlStep};
use wayfield::run::shipped;
use wayfield::simulation::Extensions;

const SETS: [ControlSet; 8] = [
    ControlSet::Decide,
    ControlSet::Actuate,
    ControlSet::Simulate,
    ControlSet::Sense,
    ControlSet::Reward,
    ControlSet::Store,
    ControlSet::Learn,
    ControlSet::Reset,
];
const ARENAS: [usize; 6] = [1, 16, 64, 256, 512, 1024];
/// Control steps before anything is measured: longer than an episode may last.
const WARM_UP: usize = 600;
/// Measured without gradient steps: so many env steps, and at least so many control steps.
const ENV_STEPS: usize = 200_000;
const MIN_STEPS: usize = 600;
/// Control steps measured with gradient steps.
const LEARNING_STEPS: usize = 5_000;

/// When each set ended, in this control step.
#[derive(Resource, Default)]
struct Ends(Vec<Instant>);

/// Notes when each set ended.
#[derive(Clone)]
struct Ticks;

impl Plugin for Ticks {
    fn build(&self, app: &mut App) {
        app.init_resource::<Ends>();
        for pair in SETS.windows(2) {
            app.add_systems(ControlStep, tick.after(pair[0].clone()).before(pair[1].clone()));
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let names: Vec<String> = SETS.iter().map(|set| format!("{set:?}")).collect();
    println!("| arenas | {} | whole |", names.join(" | "));
    println!("|---|{}---|", "---|".repeat(SETS.len()));
    for arenas in ARENAS {
        row(&arenas.to_string(), arenas, false)?;
    }
    let arenas = shipped::preset("fast")?.arenas;
    row(&format!("{arenas}, learning"), arenas, true)
}

fn row(name: &str, arenas: usize, learning: bool) -> Result<(), Box<dyn Error>> {
    let mut simulation = training_app::training(arenas, learning, &Extensions::default().plugin(Ticks))?;
    let steps = if learning { LEARNING_STEPS } else { (ENV_STEPS / arenas).max(MIN_STEPS) };
    let mut spent = [Duration::ZERO; SETS.len() + 1];
    for step in 0..WARM_UP + steps {
        simulation.world_mut().resource_mut::<Ends>().0.clear();
        let began = Instant::now();
        simulation.step()?;
        let ended = Instant::now();
        if step < WARM_UP {
            continue;
        }
        let mut from = began;
        for (set, end) in simulation.world().resource::<Ends>().0.iter().chain([&ended]).enumerate() {
            spent[set] += *end - from;
            from = *end;
        }
        spent[SETS.len()] += ended - began;
    }
    let means = spent.map(|time| format!("{:.0}", time.as_nanos() as f64 / (steps * arenas) as f64));
    println!("| {name} | {} |", means.join(" | "));
    Ok(())
}

fn tick(mut ends: ResMut<Ends>) {
    ends.0.push(Instant::now());
}
