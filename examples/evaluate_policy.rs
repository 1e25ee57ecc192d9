//! An evaluation: the shipped policy for Scenario I in 100 new episodes.
//!
//! `cargo run --release --no-default-features --example evaluate_policy`

use std::cmp::Ordering;
use std::sync::Arc;

use wayfield::run::evaluate::{EpisodeRecord, Evaluation, Evaluator, shortest_paths_m};
use wayfield::run::shipped;
use wayfield::task::EpisodeSetup;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (seed, count) = (1000, 100);
    let scenario = Arc::new(shipped::scenario("scenario-1")?);
    let of_scenario = |shipped: &&shipped::ShippedPolicy| shipped.scenario_from == "scenario-1";
    let shipped = shipped::policies().iter().find(of_scenario).ok_or("no such policy")?;
    let mut evaluator = Evaluator::new(&scenario, count).measuring_paths();
    let episodes = evaluator.run(&shipped.policy, seed, count, EpisodeSetup::Random)?;
    let result = Evaluation::from_episodes(&episodes, count, &scenario.task, seed);
    let [low, high] = result.success_interval;
    println!(
        "success {:.1} % [{:.1}, {:.1}], collisions {:.1} %, time-outs {:.1} %, mean time {:.2} s",
        100.0 * result.success_rate,
        100.0 * low,
        100.0 * high,
        100.0 * result.collision_rate,
        100.0 * result.timeout_rate,
        result.mean_time_s.unwrap_or(f64::NAN)
    );
    // One record per episode, as in the file of `--eval --csv`. 0 threads: one per core.
    let shortest_m = shortest_paths_m(&scenario, &episodes, 0);
    let records = episodes.iter().zip(shortest_m).enumerate().map(|(index, (episode, shortest_m))| {
        EpisodeRecord::new("scenario-1", index + 1, episode, &scenario, shortest_m, None)
    });
    let closest =
        records.min_by(|a, b| a.min_clearance_m.partial_cmp(&b.min_clearance_m).unwrap_or(Ordering::Equal));
    if let Some(EpisodeRecord { episode, outcome, min_clearance_m: Some(clearance_m), .. }) = closest {
        println!("closest: {clearance_m:.3} m in episode {episode} ({outcome})");
    }
    Ok(())
}
