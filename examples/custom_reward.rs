//! A custom reward term, added by a plugin: a penalty for turning, logged like the paper's own terms.
//!
//! `cargo run --release --no-default-features --example custom_reward -- [FOLDER]`

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use bevy::prelude::*;
use wayfield::run::folder::RunConfig;
use wayfield::run::preset::Budget;
use wayfield::run::train::{CHECKPOINT_INTERVAL, Job, train};
use wayfield::simulation::Extensions;
use wayfield::task::{Arena, ExtraRewards, RewardTerm, SimulationAppExt, Twist};

/// A penalty of `per_rad` for every radian that the robot turns. The control period is 0.2 s.
#[derive(Clone)]
struct SmoothDriving {
    per_rad: f32,
}

impl Plugin for SmoothDriving {
    fn build(&self, app: &mut App) {
        let per_rad = self.per_rad;
        app.add_reward_term("smoothness", move |term: RewardTerm| {
            move |mut rewards: ResMut<ExtraRewards>, arenas: Query<(&Arena, &Twist)>| {
                for (arena, twist) in &arenas {
                    rewards.set(arena.0, term, -per_rad * (0.2 * twist.w_rad_s).abs());
                }
            }
        });
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args_os().nth(1).map_or_else(|| "runs/custom-reward".into(), PathBuf::from);
    let extensions = Extensions::default().plugin(SmoothDriving { per_rad: 2.0 });
    let mut config = RunConfig::resolve("scenario-1", "fast", 7)?.with_extensions(&extensions);
    config.preset.budget = Budget::EnvSteps(20_000);
    let job = Job::New { config: Box::new(config), policy: None, out: Some(folder) };
    let (folder, summary) = train(job, CHECKPOINT_INTERVAL, &AtomicBool::new(false), Instant::now(), None)?;
    let rows = std::fs::read_to_string(folder.join("episodes.csv"))?;
    println!("{} episodes; columns of episodes.csv:", summary.episodes);
    println!("{}", rows.lines().next().unwrap_or_default());
    Ok(())
}
