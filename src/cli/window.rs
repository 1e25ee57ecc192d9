//! The app, which opens if no mode is given.

use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::Args;

use super::shared::SharedArgs;
use super::values;
use crate::app::{
    commands::Pace,
    screenshot::ScreenshotRequest,
    session::{AutosaveOptions, StartOptions, autosave::AUTOSAVE_INTERVAL},
    view_state::{Overlays, ThemeChoice},
    window::{self, WindowOptions},
};
use crate::limits::{MAX_EVAL_EPISODES, MAX_STEPS};
use crate::run::folder::RunConfig;
use crate::run::output_file::check_writable;
use crate::run::progress::print_stderr;
use crate::run::settings::Settings;
use crate::run::{RunError, shipped};
use crate::scenario::read_text;

/// The options of the app.
#[derive(Args, Debug)]
#[command(next_help_heading = "Options of the app")]
pub struct WindowArgs {
    /// Open a policy or a classical driver (a file, or a shipped one by name), a run folder, a scenario or a preset
    #[arg(long, value_name = "PATH")]
    open: Option<PathBuf>,

    /// Begin comparisons with episode N of an evaluation with --seed: its start, goal, obstacles and noise
    #[arg(long, value_name = "N", value_parser = values::whole::<u64>(1..=MAX_EVAL_EPISODES), allow_negative_numbers = true)]
    episode: Option<u64>,

    /// Open the scenario in the editor
    #[arg(long)]
    edit: bool,

    /// Initial speed as a multiple of real time, or `full` for as fast as possible [default: 5]
    #[arg(long, value_name = "X", value_parser = pace)]
    pace: Option<Pace>,

    /// Light or dark [default: the stored choice, or the system's]
    #[arg(long, value_name = "THEME", value_enum)]
    theme: Option<ThemeArg>,

    /// Overlays to show: beams, path, trails, potential, value, q-values, grid; `none` for no overlay
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_enum)]
    show: Vec<OverlayArg>,

    /// Save a screenshot of the app to a PNG file, then quit
    #[arg(long, value_name = "FILE")]
    screenshot: Option<PathBuf>,

    /// Take the screenshot after N control steps
    #[arg(long, value_name = "N", requires = "screenshot", default_value_t = 0,
        value_parser = values::whole::<u64>(0..=MAX_STEPS), allow_negative_numbers = true)]
    screenshot_after: u64,
}

#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum ThemeArg {
    Light,
    Dark,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum OverlayArg {
    Beams,
    Path,
    Trails,
    Potential,
    Value,
    QValues,
    Grid,
    None,
}

/// Opens the app and returns when its window is closed. The training is autosaved every `save_every` (by default, every
/// [`AUTOSAVE_INTERVAL`]), but not for a screenshot.
///
/// # Errors
/// An option, the scenario or the preset is invalid, the window cannot be opened, or a signal or a failure has closed it.
pub fn run(args: WindowArgs, shared: SharedArgs, save_every: Option<Duration>) -> Result<(), RunError> {
    let size = shared.size.map(window_size).transpose()?;
    let defaults = StartOptions::default();
    let autosave = AutosaveOptions::in_data_folder(save_every.unwrap_or(AUTOSAVE_INTERVAL));
    let preset = shared.preset.unwrap_or(defaults.preset);
    let start = StartOptions {
        scenario: match shared.scenario {
            Some(scenario) => scenario,
            None => shipped::preset(&preset)?.scenario.unwrap_or(defaults.scenario),
        },
        preset,
        settings: Settings(shared.set),
        seed: shared.seed.unwrap_or(defaults.seed),
        pace: args.pace.unwrap_or(defaults.pace),
        open: args.open.clone(),
        episode: args.episode.map_or(0, |number| number - 1),
        edit: args.edit,
        autosave: args.screenshot.is_none().then_some(autosave),
        extensions: shared.extensions,
        ..defaults
    };
    args.screenshot.as_deref().map_or(Ok(()), check_screenshot_file)?;
    check_start_files(&start, args.screenshot.is_some())?;
    window::run(WindowOptions {
        start,
        overlays: args.overlays(),
        grid: args.grid(),
        screenshot: args
            .screenshot
            .map(|file| ScreenshotRequest { file, after_steps: args.screenshot_after }),
        theme: args.theme.map(ThemeChoice::from),
        size,
    })
}

/// Checks the scenario and the preset before the window opens. An invalid scenario file is only reported on stderr,
/// because the app loads it once the user has fixed it. For a screenshot it is an error.
fn check_start_files(start: &StartOptions, screenshot: bool) -> Result<(), RunError> {
    let scenario = Path::new(&start.scenario);
    // If it were opened as a scenario, the editor could overwrite the run's configuration.
    if read_text(scenario).is_ok_and(|text| RunConfig::looks_like(&text)) {
        let why = "this is the configuration of a run; help: open the run's folder with --open";
        return Err(RunError::invalid_input(scenario, why));
    }
    match shipped::scenario_or_set(&start.scenario) {
        Err(error) if Path::new(&start.scenario).is_file() && !screenshot => {
            print_stderr(&error.to_string());
        }
        loaded => drop(loaded?),
    }
    start.settings.apply_to_preset(&mut shipped::preset(&start.preset)?)?;
    Ok(())
}

/// Checks the screenshot's file before training begins, because training may take hours.
fn check_screenshot_file(path: &Path) -> Result<(), RunError> {
    if !path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png")) {
        let why = "screenshots are PNG files; help: give a file name that ends in .png";
        return Err(RunError::invalid_input(path, why));
    }
    check_writable(path)
}

impl WindowArgs {
    /// The overlays in `--show`; `None` without this flag.
    fn overlays(&self) -> Option<Overlays> {
        let shows = |overlay| self.show.contains(&overlay);
        (!self.show.is_empty()).then(|| Overlays {
            beams: shows(OverlayArg::Beams),
            path: shows(OverlayArg::Path),
            trails: shows(OverlayArg::Trails),
            potential: shows(OverlayArg::Potential),
            value: shows(OverlayArg::Value),
            q_values: shows(OverlayArg::QValues),
        })
    }

    /// Whether `--show` includes the grid; `None` without this flag.
    fn grid(&self) -> Option<bool> {
        (!self.show.is_empty()).then(|| self.show.contains(&OverlayArg::Grid))
    }
}

impl From<ThemeArg> for ThemeChoice {
    fn from(theme: ThemeArg) -> Self {
        match theme {
            ThemeArg::Light => Self::Light,
            ThemeArg::Dark => Self::Dark,
        }
    }
}

fn pace(text: &str) -> Result<Pace, String> {
    text.parse()
}

/// The window's size in points.
fn window_size((width, height): (u16, u16)) -> Result<(f32, f32), RunError> {
    if (800..=8000).contains(&width) && (500..=8000).contains(&height) {
        return Ok((width.into(), height.into()));
    }
    let what = format!("--size {width}x{height} is not a valid window size");
    Err(RunError::InvalidInput(format!(
        "{what}; help: give width and height in points, 800x500 to 8000x8000"
    )))
}
