//! The failures in a suite: a picture of each, and a scenario in which it can be repeated.

use std::path::{Path, PathBuf};

use super::suite::Tested;
use crate::run::evaluate::{EpisodeResult, Evaluator, outcome_name, period_s};
use crate::run::suite::{SuiteEpisodes, episode_setup};
use crate::run::{RunError, on_all_cores};
use crate::scenario::{PlacementRule, Scenario, to_text, vec2};

/// The folder of the scenarios, in that of the report.
pub const FOLDER: &str = "failures";

/// A failed episode.
pub struct Failure {
    /// The number of the driver under test, and of the scenario's family.
    pub driver: usize,
    pub family: usize,
    /// The number of the episode in its scenario, from 1.
    pub episode: usize,
    /// The stem of the names of its files.
    pub file: String,
    /// What happened.
    pub text: String,
    /// The picture, as SVG.
    pub svg: String,
    /// The text of the scenario with the failure's start and goal.
    pub scenario: String,
}

/// An episode that failed.
struct Place<'a> {
    driver: usize,
    family: usize,
    scenario: &'a str,
    of: &'a SuiteEpisodes,
    index: usize,
}

/// The failures of all drivers, in the order of the families, then of the drivers. Their pictures are made on all cores.
///
/// # Errors
/// An episode cannot be repeated or drawn, or the work was stopped.
pub fn failures(tested: &Tested<'_>) -> Result<Vec<Failure>, RunError> {
    let places = places(tested);
    let draw = |_: &mut (), number: usize| {
        tested.test.check_signals()?;
        places[number].draw(number + 1, tested)
    };
    on_all_cores::map(places.len(), 0, || (), draw).into_iter().collect()
}

fn places<'a>(tested: &'a Tested<'_>) -> Vec<Place<'a>> {
    let mut places = Vec::new();
    let mut first = 0;
    for (family, of_family) in tested.test.suite.families.iter().enumerate() {
        for (driver, found) in tested.found.iter().enumerate() {
            for (k, scenario) in of_family.scenarios.iter().enumerate() {
                let of = &found[first + k];
                let failed = of.episodes.iter().enumerate().filter(|(_, episode)| !episode.succeeded());
                places.extend(failed.map(|(index, _)| Place {
                    driver,
                    family,
                    scenario: &scenario.name,
                    of,
                    index,
                }));
            }
        }
        first += of_family.scenarios.len();
    }
    places
}

impl Place<'_> {
    fn draw(&self, number: usize, tested: &Tested<'_>) -> Result<Failure, RunError> {
        let Self { driver, family, scenario: name, of, index } = *self;
        let setup = episode_setup(&tested.test.suite.families[family], &of.scenario);
        let under_test = &tested.drivers[driver];
        let mut evaluator = Evaluator::with_extensions(&of.scenario, 1, tested.test.extensions);
        let (episode, svg) = evaluator.picture(under_test.evaluated, tested.test.seed, index, setup)?;
        let time_s = f64::from(episode.steps) * period_s(of.scenario.task.control_period_s);
        let file = format!("failure-{number:04}");
        let number = index + 1;
        let title = format!("{name}, episode {number}");
        let text =
            format!("{} in {title}: {} after {time_s:.1} s", under_test.name, outcome_name(episode.end));
        let scenario = to_text(&repeatable(&of.scenario, &episode, &text), None);
        Ok(Failure { driver, family, episode: number, file, text, svg, scenario })
    }
}

/// `scenario` with the start, the goal and the generated obstacles of `episode`. What else is random in it, the window takes from
/// the seed and the number of the episode: where moving obstacles begin, and noise.
fn repeatable(scenario: &Scenario, episode: &EpisodeResult, text: &str) -> Scenario {
    let EpisodeResult { start, goal, layout_seed, .. } = episode;
    let fixed = |x_m, y_m, heading_rad| PlacementRule::Fixed { position_m: vec2(x_m, y_m), heading_rad };
    Scenario {
        about: format!("A failure in {}: {text}.", scenario.name).chars().take(2_000).collect(),
        starts: fixed(start.x_m, start.y_m, Some(start.heading_rad)),
        goals: fixed(goal.x_m, goal.y_m, None),
        ..scenario.with_generated_obstacles(*layout_seed)
    }
}

/// The command that repeats a failure of the test with `seed` in the window.
pub fn command(report: &Path, failure: &Failure, seed: u64, driver: &Path) -> String {
    let scenario: PathBuf = report.join(FOLDER).join(format!("{}.ron", failure.file));
    let (scenario, episode, driver) = (scenario.display(), failure.episode, driver.display());
    format!("wayfield --scenario {scenario} --seed {seed} --episode {episode} --open {driver}")
}
