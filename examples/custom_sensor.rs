//! A custom sensor, added by a plugin: the robot's speed and turning rate become part of the observation.
//!
//! The policy file records the sensor. Evaluation works with the same plugin and fails without it.
//!
//! `cargo run --release --no-default-features --example custom_sensor -- [FOLDER]`

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use bevy::prelude::*;
use wayfield::run::evaluate::{Evaluation, Evaluator};
use wayfield::run::folder::RunConfig;
use wayfield::run::policy_card;
use wayfield::run::preset::Budget;
use wayfield::run::train::{CHECKPOINT_INTERVAL, Job, train};
use wayfield::simulation::Extensions;
use wayfield::task::{EpisodeSetup, SensorReadings, SensorSlice, SimulationAppExt, Twist};

/// A sensor with two readings: speed / 0.15 m/s and turning rate / 1.5 rad/s.
#[derive(Clone)]
struct Odometry;

impl Plugin for Odometry {
    fn build(&self, app: &mut App) {
        app.add_sensor("odometry", 2, |slice: SensorSlice| {
            move |mut arenas: Query<(&Twist, &mut SensorReadings)>| {
                for (twist, mut readings) in &mut arenas {
                    let odometry = [twist.v_m_s / 0.15, twist.w_rad_s / 1.5];
                    readings.slice_mut(&slice).copy_from_slice(&odometry);
                }
            }
        });
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args_os().nth(1).map_or_else(|| "runs/custom-sensor".into(), PathBuf::from);
    let extensions = Extensions::default().plugin(Odometry);
    let mut config = RunConfig::resolve("scenario-1", "fast", 7)?.with_extensions(&extensions);
    config.preset.budget = Budget::EnvSteps(40_000);
    let scenario = Arc::new(config.scenario.clone());
    let job = Job::New { config: Box::new(config), policy: None, out: Some(folder) };
    let (folder, _) = train(job, CHECKPOINT_INTERVAL, &AtomicBool::new(false), Instant::now(), None)?;

    let policy = policy_card::read(&folder.join("policy.safetensors"))?;
    println!("the policy has {} inputs: the paper's 28 and the odometry's 2", policy.shape().inputs);
    let (seed, count) = (1000, 100);
    let mut evaluator = Evaluator::with_extensions(&scenario, count, &extensions);
    let episodes = evaluator.run(&policy, seed, count, EpisodeSetup::Random)?;
    let result = Evaluation::from_episodes(&episodes, count, &scenario.task, seed);
    println!("with the plugin: {:.1} % success", 100.0 * result.success_rate);
    match Evaluator::new(&scenario, count).run(&policy, seed, count, EpisodeSetup::Random) {
        Err(error) => println!("without the plugin: {error}"),
        Ok(_) => return Err("the evaluation must fail without the sensor used in training".into()),
    }
    Ok(())
}
