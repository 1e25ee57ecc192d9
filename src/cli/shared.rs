//! The options that several modes take.

use std::path::PathBuf;

use clap::Args;

use super::values;
use crate::run::folder::DEFAULT_SCENARIO;
use crate::run::settings::{Setting, Settings};
use crate::simulation::Extensions;

/// The options that several modes take ([`modes`](super::modes) lists them by mode).
#[derive(Args, Debug)]
#[command(next_help_heading = "Options of several modes")]
pub struct SharedArgs {
    /// The scenario: a RON file, or a shipped one by name (scenario-1, scenario-2, empty, corridor, doorway,
    /// slalom, random-field, u-trap, crossing, crowd, hall, maze); with --train, --eval, --draw and in the app also a set of
    /// scenarios or a level generator [default: the preset's, else scenario-1; with --eval the one that the policy was
    /// trained in]
    #[arg(long, value_name = "FILE")]
    pub scenario: Option<String>,

    /// The training preset: a RON file, or a shipped one by name (fast, general, per_d3qn, per_d3qn_tuned, dqn)
    /// [default: fast]
    #[arg(long, value_name = "FILE")]
    pub preset: Option<String>,

    /// Set a field of the preset, such as learning.gamma=0.97, or of the scenario, such as
    /// scenario.lidar.noise_std_m=0.02; may be repeated. The value is written as in the file, in quotes for the shell
    /// if it has brackets: 'learning.loss=Huber(delta: 1)'
    #[arg(long, value_name = "PATH=VALUE")]
    pub set: Vec<Setting>,

    /// The seed of every random stream [default: 0]
    #[arg(long, value_name = "N", value_parser = values::seed, allow_negative_numbers = true)]
    pub seed: Option<u64>,

    /// With --train: stop after N episodes [default: the preset's budget]. With --eval: episodes per round
    /// [default: 100]
    #[arg(long, value_name = "N", value_parser = values::budget, allow_negative_numbers = true)]
    pub episodes: Option<u64>,

    /// The output. With --train: a new run folder [default: runs/<scenario>-<preset>-<seed>, with -2, -3, ... appended if
    /// that exists]. With --reproduce: the report's folder; an earlier report there is continued, unless it is of other
    /// experiments or more seeds [default: runs/reproduce; with --experiment: runs/reproduce-<experiment>]. With --import: the
    /// scenario file, or a folder for all worlds of a file
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,

    /// The size of the figure of --draw in pixels (96 per inch in PDF), such as 1600x1200 [default: the figure's own, which
    /// is 640 wide; in PNG four times that].
    #[cfg_attr(feature = "gui", doc = "In the app: the size of the window in points")]
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    pub size: Option<(u16, u16)>,

    /// Print JSON instead of text
    #[arg(long)]
    pub json: bool,

    /// A user's plugins ([`main`](super::main)).
    #[arg(skip)]
    pub extensions: Extensions,
}

impl SharedArgs {
    /// The scenario's file or shipped name.
    pub fn scenario(&self) -> &str {
        self.scenario.as_deref().unwrap_or(DEFAULT_SCENARIO)
    }

    /// The preset's file or shipped name.
    pub fn preset(&self) -> &str {
        self.preset.as_deref().unwrap_or("fast")
    }

    /// The settings of `--set`.
    pub fn settings(&self) -> Settings {
        Settings(self.set.clone())
    }

    /// The seed.
    pub fn seed(&self) -> u64 {
        self.seed.unwrap_or(0)
    }
}
