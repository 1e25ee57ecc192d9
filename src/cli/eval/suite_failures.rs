//! The failures in a suite: an image of each, and a scenario in which it can be repeated.

use std::path::{Path, PathBuf};

use super::suite::Tested;
use crate::run::evaluate::{EpisodeResult, Evaluator, outcome_name, period_s};
use crate::run::suite::{SuiteEpisodes, episode_setup};
use crate::run::{RunError, on_all_cores};
use crate::scenario::{PlacementRule, Scenario, quoted, to_text, vec2};

/// The folder of the failures' scenarios, in the report's folder.
pub const FOLDER: &str = "failures";
/// The prefix of a failure's file name, followed by a number.
const PREFIX: &str = "failure-";

/// A failed episode, drawn.
pub struct Failure {
    /// Index of the driver.
    pub driver: usize,
    /// Index of the scenario's family.
    pub family: usize,
    /// The number of the episode in its scenario, from 1.
    pub episode: usize,
    /// The name of its files, without the extension.
    pub file: String,
    /// The driver, the episode and how it ended, in words.
    pub text: String,
    /// The image, as SVG.
    pub svg: String,
    /// The text of the scenario with the failure's start and goal.
    pub scenario: String,
}

/// An episode that failed, to be drawn.
struct FailedEpisode<'a> {
    driver: usize,
    family: usize,
    scenario_name: &'a str,
    suite_episodes: &'a SuiteEpisodes,
    /// Index of the episode in `suite_episodes`.
    index: usize,
}

/// The failures of all drivers, in the order of the families, then of the drivers. They are drawn on all cores.
///
/// # Errors
/// An episode cannot be repeated or drawn, or the work was stopped.
pub fn failures(tested: &Tested<'_>) -> Result<Vec<Failure>, RunError> {
    let failed = failed_episodes(tested);
    let draw = |_: &mut (), index: usize| {
        tested.test.check_not_stopped()?;
        failed[index].draw(index + 1, tested)
    };
    on_all_cores::map(failed.len(), 0, || (), draw).into_iter().collect()
}

fn failed_episodes<'a>(tested: &'a Tested<'_>) -> Vec<FailedEpisode<'a>> {
    let mut all = Vec::new();
    let mut first = 0;
    for (family, of_family) in tested.test.suite.families.iter().enumerate() {
        for (driver, episodes) in tested.episodes.iter().enumerate() {
            for (k, scenario) in of_family.scenarios.iter().enumerate() {
                let suite_episodes = &episodes[first + k];
                let all_episodes = suite_episodes.episodes.iter().enumerate();
                let failed = all_episodes.filter(|(_, episode)| !episode.succeeded());
                all.extend(failed.map(|(index, _)| FailedEpisode {
                    driver,
                    family,
                    scenario_name: &scenario.name,
                    suite_episodes,
                    index,
                }));
            }
        }
        first += of_family.scenarios.len();
    }
    all
}

impl FailedEpisode<'_> {
    /// Draws the failure with this number in the report, from 1.
    fn draw(&self, failure_number: usize, tested: &Tested<'_>) -> Result<Failure, RunError> {
        let Self { driver, family, scenario_name, suite_episodes, index } = *self;
        let scenario = &suite_episodes.scenario;
        let setup = episode_setup(&tested.test.suite.families[family], scenario);
        let under_test = &tested.drivers[driver];
        let mut evaluator = Evaluator::with_extensions(scenario, 1, tested.test.extensions);
        let (episode, svg) = evaluator.episode_image(under_test.evaluated, tested.test.seed, index, setup)?;
        let time_s = f64::from(episode.steps) * period_s(scenario.task.control_period_s);
        let file = format!("{PREFIX}{failure_number:04}");
        let episode_number = index + 1;
        let title = format!("{scenario_name}, episode {episode_number}");
        let text =
            format!("{} in {title}: {} after {time_s:.1} s", under_test.name, outcome_name(episode.end));
        let scenario = to_text(&repeatable(scenario, &episode, &text), None);
        Ok(Failure { driver, family, episode: episode_number, file, text, svg, scenario })
    }
}

/// `scenario` with the start, the goal, the generated obstacles and the drawn numbers of `episode`. The app derives the noise and
/// the initial poses of moving obstacles from the seed and the number of the episode.
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

/// Whether `name` is that of a failure's scenario.
pub fn is_file_name(name: &str) -> bool {
    let number = name.strip_prefix(PREFIX).and_then(|rest| rest.strip_suffix(".ron"));
    number.is_some_and(|number| number.parse::<usize>().is_ok())
}

/// The shell command that repeats `failure`, an episode of the test with `seed`, in the app.
pub fn command(report: &Path, failure: &Failure, seed: u64, driver: &Path) -> String {
    let scenario: PathBuf = report.join(FOLDER).join(format!("{}.ron", failure.file));
    let (scenario, episode, driver) = (quoted(scenario), failure.episode, quoted(driver));
    format!("wayfield --scenario {scenario} --seed {seed} --episode {episode} --open {driver}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_of_a_failure_can_be_pasted_into_a_shell() {
        let failure = Failure {
            driver: 0,
            family: 0,
            episode: 7,
            file: "failure-0001".into(),
            text: String::new(),
            svg: String::new(),
            scenario: String::new(),
        };
        assert_eq!(
            command(Path::new("my report"), &failure, 5, Path::new("my report/drivers/1-field.ron")),
            "wayfield --scenario 'my report/failures/failure-0001.ron' --seed 5 --episode 7 \
             --open 'my report/drivers/1-field.ron'"
        );
    }
}
