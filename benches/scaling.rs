//! The time of an env step by the number of arenas, and of a gradient step by the size of the replay buffer; the memory of both.
//!
//! `cargo bench --no-default-features --bench scaling -- [SVG]` prints two tables. With a path, it also draws them. An env
//! step here is a complete training step of the preset `fast` without gradient steps: forward pass, exploration, rapier,
//! LIDAR, observation, reward, replay buffer. Gradient steps are those of the preset `per_d3qn_tuned`. With `--test`, each
//! measurement only runs briefly, and nothing is printed.

#[path = "support/allocator.rs"]
mod allocator;
#[path = "support/process.rs"]
mod process;
#[path = "support/training_app.rs"]
mod training_app;

use std::error::Error;
use std::process::{Command, Stdio};
use std::time::Instant;

use plotters::prelude::*;
use process::status_kb;
use wayfield::agent::ActiveLearner;
use wayfield::learning::{Experience, Learner, LearningConfig};
use wayfield::run::shipped;
use wayfield::simulation::Extensions;

const ARENAS: [usize; 7] = [1, 4, 16, 64, 256, 512, 1024];
const REPLAY: [usize; 4] = [1_000, 10_000, 100_000, 1_000_000];
const ENV_STEPS: usize = 150_000;
const GRADIENT_STEPS: u32 = 3_000;

/// One row of a table: size, microseconds per step, kB of memory.
type Row = (usize, f64, f64);

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    // Every row is measured in a new process, so that no row reuses the memory of another.
    if let [kind, size] = arguments.as_slice() {
        let size = size.parse()?;
        let (us, kb) =
            if kind == "arenas" { env_step(size, ENV_STEPS)? } else { gradient_step(size, GRADIENT_STEPS)? };
        println!("{us} {kb}");
        return Ok(());
    }
    if std::env::args().any(|argument| argument == "--test") {
        env_step(ARENAS[1], 100)?;
        gradient_step(REPLAY[0], 10)?;
        return Ok(());
    }
    let arenas = ARENAS.iter().map(|&n| row("arenas", n)).collect::<Result<Vec<_>, _>>()?;
    let min = |rows: &[Row]| rows.iter().map(|row| row.1).fold(f64::INFINITY, f64::min);
    println!(
        "| arenas | us per env step | relative to the minimum | env steps/s | MB |\n|---|---|---|---|---|"
    );
    for (n, us, kb) in &arenas {
        println!("| {n} | {us:.2} | {:.2} | {:.0} | {:.1} |", us / min(&arenas), 1e6 / us, kb / 1024.0);
    }
    let replay = REPLAY.iter().map(|&n| row("replay", n)).collect::<Result<Vec<_>, _>>()?;
    println!(
        "\n| transitions in the replay buffer | us per gradient step | relative to the minimum | gradient steps/s | MB |\n|---|---|---|---|---|"
    );
    for (n, us, kb) in &replay {
        println!("| {n} | {us:.1} | {:.2} | {:.0} | {:.1} |", us / min(&replay), 1e6 / us, kb / 1024.0);
    }
    if let Some(path) = arguments.first() {
        draw(path, &arenas, &replay)?;
        println!("\nfigure: {path}");
    }
    Ok(())
}

fn row(kind: &str, size: usize) -> Result<Row, Box<dyn Error>> {
    let output = Command::new(std::env::current_exe()?)
        .args([kind, &size.to_string()])
        .stderr(Stdio::inherit())
        .output()?;
    let text = String::from_utf8(output.stdout)?;
    let (us, kb) = text.trim().split_once(' ').ok_or("the process of a row printed no result")?;
    Ok((size, us.parse()?, kb.parse()?))
}

/// The learning configuration of the gradient steps.
fn config() -> Result<LearningConfig, Box<dyn Error>> {
    Ok(shipped::preset("per_d3qn_tuned")?.learning)
}

/// Measures `env_steps` env steps of Scenario I in `arenas` arenas, without gradient steps: us per env step, and kB of memory.
fn env_step(arenas: usize, env_steps: usize) -> Result<(f64, f64), Box<dyn Error>> {
    let before = status_kb("VmRSS:") as f64;
    let mut simulation =
        training_app::training(&shipped::scenario("scenario-1")?, arenas, false, &Extensions::default())?;
    for _ in 0..(2_000 / arenas).max(4) {
        simulation.step()?;
    }
    let memory_kb = status_kb("VmRSS:") as f64 - before;
    let steps = env_steps / arenas;
    let began = Instant::now();
    for _ in 0..steps {
        simulation.step()?;
    }
    let us = began.elapsed().as_secs_f64() * 1e6 / (steps * arenas) as f64;
    let gradient_steps = simulation.world().resource::<ActiveLearner>().0.gradient_steps();
    assert_eq!(gradient_steps, 0, "no gradient steps are measured");
    Ok((us, memory_kb))
}

/// Measures `gradient_steps` gradient steps with batches of 64 from a prioritized buffer with `transitions` transitions: us per
/// gradient step, and kB of memory.
fn gradient_step(transitions: usize, gradient_steps: u32) -> Result<(f64, f64), Box<dyn Error>> {
    let mut config = config()?;
    config.replay.capacity = transitions;
    config.replay.learning_starts = transitions as u64;
    config.train_freq = transitions as u64;
    config.gradient_steps = gradient_steps;
    let before = status_kb("VmRSS:") as f64;
    let mut learner = Learner::new(&config, 28, 5, 1, 1)?;
    let mut noise = wayfield::random::stream(1, "bench", 0);
    let mut random = || -> Vec<f32> { (0..28).map(|_| wayfield::random::normal(&mut noise)).collect() };
    let mut observation = random();
    for step in 0..transitions {
        let next_observation = random();
        learner.store(&Experience {
            env_index: 0,
            observation: &observation,
            action: step % 5,
            reward: observation[0],
            next_observation: &next_observation,
            terminated: false,
            truncated: false,
        });
        observation = next_observation;
    }
    let memory_kb = status_kb("VmRSS:") as f64 - before;
    let began = Instant::now();
    let taken = learner.train()?.map_or(0, |stats| stats.gradient_steps);
    let us = began.elapsed().as_secs_f64() * 1e6 / f64::from(taken);
    assert!(taken > 0, "gradient steps are measured");
    Ok((us, memory_kb))
}

fn draw(path: &str, arenas: &[Row], replay: &[Row]) -> Result<(), Box<dyn Error>> {
    let root = SVGBackend::new(path, (900, 380)).into_drawing_area();
    root.fill(&WHITE)?;
    let (left, right) = root.split_horizontally(450);
    panel(&left, "Time of an env step", "arenas", "us per env step", arenas)?;
    panel(
        &right,
        "Time of a gradient step, batch 64",
        "transitions in the replay buffer",
        "us per gradient step",
        replay,
    )?;
    root.present()?;
    Ok(())
}

fn panel(
    area: &DrawingArea<SVGBackend<'_>, plotters::coord::Shift>,
    title: &str,
    x: &str,
    y: &str,
    rows: &[Row],
) -> Result<(), Box<dyn Error>> {
    let blue = RGBColor(0, 114, 178);
    let (first, last) = (rows[0].0 as f64, rows[rows.len() - 1].0 as f64);
    let top = rows.iter().map(|row| row.1).fold(0.0, f64::max) * 1.25;
    let mut chart = ChartBuilder::on(area)
        .caption(title, ("sans-serif", 18))
        .margin(16)
        .x_label_area_size(44)
        .y_label_area_size(56)
        .build_cartesian_2d((first * 0.8..last * 1.25).log_scale(), 0.0..top)?;
    chart
        .configure_mesh()
        .disable_x_mesh()
        .light_line_style(TRANSPARENT)
        .x_desc(x)
        .y_desc(y)
        .x_label_formatter(&|n| format!("{n:.0}"))
        .y_label_formatter(&|n| format!("{n:.0}"))
        .label_style(("sans-serif", 13))
        .draw()?;
    chart.draw_series(LineSeries::new(rows.iter().map(|r| (r.0 as f64, r.1)), blue.stroke_width(2)))?;
    chart.draw_series(rows.iter().map(|r| Circle::new((r.0 as f64, r.1), 4, blue.filled())))?;
    Ok(())
}
