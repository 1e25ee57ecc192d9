//! A vectorized environment: 64 robots that turn towards their goals and ignore the obstacles.
//!
//! `cargo run --release --no-default-features --example vec_env`

use std::f32::consts::PI;
use std::time::Instant;

use wayfield::env::{VecEnv, VecEnvConfig};
use wayfield::run::shipped;

const NUM_ENVS: usize = 64;
const STEPS: usize = 2_000;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scenario = shipped::scenario("scenario-1")?;
    let beams = scenario.lidar.beams;
    let mut env = VecEnv::new(&scenario, VecEnvConfig { num_envs: NUM_ENVS, ..VecEnvConfig::default() })?;
    let width = env.observation_width();
    let mut actions = [2; NUM_ENVS];
    let mut observations = env.reset(7)?.to_vec();
    let (mut episodes, mut reached, started) = (0, 0, Instant::now());
    for _ in 0..STEPS {
        for (action, row) in actions.iter_mut().zip(observations.chunks_exact(width)) {
            // The number after the ranges is the goal's bearing / pi, left positive. Actions: 0 turns left, 2 drives
            // straight, 4 turns right.
            let bearing_rad = row[beams] * PI;
            *action = if bearing_rad > 0.2 {
                0
            } else if bearing_rad < -0.2 {
                4
            } else {
                2
            };
        }
        let step = env.step(&actions)?;
        observations.copy_from_slice(step.observations);
        episodes += step.ended.len();
        reached += step.outcomes.iter().filter(|outcome| outcome.reached).count();
    }
    let per_second = (NUM_ENVS * STEPS) as f64 / started.elapsed().as_secs_f64();
    println!("{reached} of {episodes} episodes reached the goal; {per_second:.0} env steps/s");
    Ok(())
}
