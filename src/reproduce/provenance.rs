//! The provenance of a report: version, command, seeds, training runs, machine and time.

use std::collections::BTreeSet;

use super::options::ReproduceOptions;
use super::plan::{PlannedRun, RunPlan};
use super::results::Results;
use super::seeds::seeds_text;
use crate::report::format::counted;
use crate::run::provenance::{COMMIT, VERSION};
use crate::scenario::printable_path;

/// The provenance of a report, as names and values.
pub fn provenance(
    results: &Results<'_>,
    plan: &RunPlan,
    options: &ReproduceOptions,
    jobs: usize,
    wall_s: f64,
) -> Vec<(String, String)> {
    let seeds: BTreeSet<u64> = plan.training_runs.iter().map(|training| training.config.seed).collect();
    let seeds: Vec<u64> = seeds.into_iter().collect();
    let entries = [
        ("Version", version()),
        ("Command", options.command()),
        ("Seeds", seeds_text(&seeds)),
        (
            "Training runs",
            format!(
                "{}: {} in {}",
                plan.training_runs.len(),
                counted(results.total_env_steps() as f64, "env step"),
                counted(results.total_episodes() as f64, "episode")
            ),
        ),
        ("Machine", machine()),
        ("Processors", processors(results)),
        (
            "Time",
            format!(
                "{:.1} minutes with {} in parallel; {:.1} minutes as the sum of all runs",
                wall_s / 60.0,
                counted(jobs as f64, "run"),
                results.total_wall_minutes()
            ),
        ),
    ];
    let elsewhere = trained_elsewhere(plan).map(|runs| ("Trained elsewhere", runs));
    entries.into_iter().chain(elsewhere).map(|(name, value)| (name.to_string(), value)).collect()
}

/// The runs that were trained elsewhere, with their versions.
fn trained_elsewhere(plan: &RunPlan) -> Option<String> {
    let run = |training: &PlannedRun| {
        let folder = &training.elsewhere.as_ref()?.folder;
        Some(format!("{} (wayfield {})", printable_path(folder), training.config.version))
    };
    let runs: Vec<String> = plan.training_runs.iter().filter_map(run).collect();
    (!runs.is_empty()).then(|| runs.join(", "))
}

/// The program with its version and commit.
fn version() -> String {
    let commit = COMMIT.map_or(String::new(), |commit| format!(", commit {commit}"));
    format!("wayfield {VERSION}{commit}")
}

/// The kinds of processor that the runs were trained on.
fn processors(results: &Results<'_>) -> String {
    let counts = results.processors();
    let run = |(kind, count): (&String, &usize)| match count {
        1 => format!("1 run on {kind}"),
        _ => format!("{count} runs on {kind}"),
    };
    let runs: Vec<String> = counts.iter().map(run).collect();
    let mixed = "; a run gives the same bits only on the same kind of processor";
    runs.join("; ") + if counts.len() > 1 { mixed } else { "" }
}

/// Processor, cores, memory and operating system, as far as they are known.
fn machine() -> String {
    let mut parts = Vec::new();
    if let Ok(mut system) = sysinfo::System::new() {
        system.refresh_memory();
        system.refresh_cpu_all();
        let cpus = system.cpus();
        if let Some(cpu) = cpus.first() {
            parts.push(cpu.brand().trim().to_string());
        }
        parts.push(counted(cpus.len() as f64, "core"));
        parts.push(format!("{:.0} GiB", system.total_memory() as f64 / f64::from(1 << 30)));
    }
    parts.push(sysinfo::System::long_os_version().unwrap_or_else(|_| std::env::consts::OS.into()));
    parts.join(", ")
}
