//! Measures the time of each system set in a control step.
//!
//! `cargo bench --no-default-features --bench profile` prints nanoseconds per env step: in Scenario I without gradient
//! steps, for several numbers of arenas; in Scenario I with the gradient steps of the default preset; and in two large
//! scenarios without gradient steps. The numbers are means over control steps in which the arenas are at all stages of
//! an episode. A system between two sets reads the clock, which takes about 40 ns and matters only with one arena.
//! `Decide` includes the start of the schedule, and `Reset` the check for faults after the schedule.

#[path = "support/allocator.rs"]
mod allocator;
#[path = "../tests/common/mod.rs"]
mod common;
#[path = "support/training_app.rs"]
mod training_app;

use std::error::Error;
use std::time::{Duration, Instant};

use bevy::prelude::*;
use wayfield::control_step::{ControlSet, ControlStep};
use wayfield::run::shipped;
use wayfield::scenario::Scenario;
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
/// Control steps before the measurement: more than the longest episode in Scenario I or BARN.
const WARM_UP: usize = 600;
/// Measured env steps without gradient steps.
const ENV_STEPS: usize = 200_000;
/// The minimum number of measured control steps without gradient steps.
const MIN_STEPS: usize = 600;
/// Measured control steps with gradient steps.
const LEARNING_STEPS: usize = 5_000;

/// The times at which the sets of this control step ended, except the last one: the end of `Reset` is that of the step.
#[derive(Resource, Default)]
struct SetEnds(Vec<Instant>);

/// Records the end of every set but the last.
#[derive(Clone)]
struct RecordSetEnds;

impl Plugin for RecordSetEnds {
    fn build(&self, app: &mut App) {
        app.init_resource::<SetEnds>();
        for pair in SETS.windows(2) {
            app.add_systems(ControlStep, record.after(pair[0].clone()).before(pair[1].clone()));
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let names: Vec<String> = SETS.iter().map(|set| format!("{set:?}")).collect();
    println!("| arenas | {} | total |", names.join(" | "));
    println!("|---|{}---|", "---|".repeat(SETS.len()));
    let scenario = shipped::scenario("scenario-1")?;
    for arenas in ARENAS {
        print_row(&arenas.to_string(), &measure(&scenario, arenas, false)?);
    }
    let arenas = shipped::preset("fast")?.arenas;
    print_row(&format!("{arenas}, training"), &measure(&scenario, arenas, true)?);
    for (name, large) in [("BARN", common::large_worlds::barn()), ("office", common::large_worlds::office())]
    {
        print_row(&format!("64, {name}"), &measure(&large, 64, false)?);
    }
    Ok(())
}

/// The mean times per env step of each set and of the whole step, in ns.
fn measure(
    scenario: &Scenario,
    arenas: usize,
    learning: bool,
) -> Result<[f64; SETS.len() + 1], Box<dyn Error>> {
    let recorder = Extensions::default().plugin(RecordSetEnds);
    let mut simulation = training_app::training(scenario, arenas, learning, &recorder)?;
    let steps = if learning { LEARNING_STEPS } else { (ENV_STEPS / arenas).max(MIN_STEPS) };
    let mut spent = [Duration::ZERO; SETS.len() + 1];
    for step in 0..WARM_UP + steps {
        simulation.world_mut().resource_mut::<SetEnds>().0.clear();
        let began = Instant::now();
        simulation.step()?;
        let ended = Instant::now();
        if step < WARM_UP {
            continue;
        }
        let mut from = began;
        for (set, end) in simulation.world().resource::<SetEnds>().0.iter().chain([&ended]).enumerate() {
            spent[set] += *end - from;
            from = *end;
        }
        spent[SETS.len()] += ended - began;
    }
    Ok(spent.map(|time| time.as_nanos() as f64 / (steps * arenas) as f64))
}

fn print_row(name: &str, means_ns: &[f64]) {
    let cells: Vec<String> = means_ns.iter().map(|mean| format!("{mean:.0}")).collect();
    println!("| {name} | {} |", cells.join(" | "));
}

fn record(mut ends: ResMut<SetEnds>) {
    ends.0.push(Instant::now());
}
