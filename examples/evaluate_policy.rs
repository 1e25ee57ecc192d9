//! An evaluation: the shipped policy for Scenario I in 100 new episodes.
//!
//! `cargo run --release --no-default-features --example evaluate_policy`

use std::sync::Arc;

use wayfield::run::evaluate::{Evaluation, Evaluator};
use wayfield::run::shipped;
use wayfield::task::EpisodeSetup;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (seed, count) = (1000, 100);
    let scenario = Arc::new(shipped::scenario("scenario-1")?);
    let of_scenario = |shipped: &&shipped::ShippedPolicy| shipped.scenario_from == "scenario-1";
    let shipped = shipped::policies().iter().find(of_scenario).ok_or("no such policy")?;
    let episodes =
        Evaluator::new(&scenario, count).run(&shipped.policy, seed, count, EpisodeSetup::Random)?;
    let result = Evaluation::from_episodes(&episodes, count, &scenario.task, seed);
    println!(
        "success {:.1} %, collisions {:.1} %, time-outs {:.1} %, mean time {:.2} s",
        100.0 * result.success_rate,
        100.0 * result.collision_rate,
        100.0 * result.timeout_rate,
        result.mean_time_s.unwrap_or(f64::NAN)
    );
    Ok(())
}
