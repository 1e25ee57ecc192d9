//! The figure of a scenario, drawn over its map if the user names one, and the contact sheet of a level generator or a set.

use std::path::Path;

use bevy::math::DVec2;

use crate::import::{Frame, ImportOptions, backdrop};
use crate::run::settings::Settings;
use crate::run::shipped::Source;
use crate::run::{RunError, scenario_image};
use crate::scenario::{LevelGenerator, Scenario, ScenarioSet};

/// Default number of levels on a contact sheet.
const DEFAULT_LEVELS: u64 = 12;

/// How a scenario, a level generator or a set is drawn.
pub struct ScenarioFigure<'a> {
    /// Its file or shipped name, for messages.
    pub name: &'a str,
    /// Values to set in the scenario before it is drawn.
    pub settings: &'a Settings,
    /// Whether to leave out its name, the legend and the axes.
    pub is_plain: bool,
    /// The number of levels on the contact sheet of a level generator.
    pub levels: Option<u64>,
    /// The seed of the first level on the contact sheet, or of the only level; 0 if `None`.
    pub seed: Option<u64>,
    /// The map from which the scenario was imported; its occupied cells are marked.
    pub over: Option<&'a Path>,
    /// The side of a pixel in m, if `over` is a plain image.
    pub resolution_m: Option<f64>,
}

impl ScenarioFigure<'_> {
    /// The figure of `source` as SVG.
    ///
    /// # Errors
    /// A setting or the map is invalid, an option is for level generators only or needs a single scenario, or a level cannot be
    /// generated.
    pub fn svg(&self, source: Source) -> Result<String, RunError> {
        let only_for_levels = self.levels.map(|_| "--levels").or(self.seed.map(|_| "--seed"));
        let mut scenario = match (source, only_for_levels) {
            (Source::Levels(generator), _) if !self.is_plain && self.over.is_none() => {
                return self.contact_sheet(&generator);
            }
            (Source::Levels(generator), _) => self.level(&generator, 0)?,
            (Source::Set(_, set), None) if !self.is_plain && self.over.is_none() => {
                return self.sheet_of_set(&set);
            }
            (Source::Scenario(_), Some(flag)) => return Err(self.only_for_levels("scenario", flag)),
            (Source::Set(..), Some(flag)) => return Err(self.only_for_levels("set of scenarios", flag)),
            (source, _) => source.into_scenario(self.name)?,
        };
        self.settings.apply_to_scenario(&mut scenario)?;
        let svg = match self.over {
            Some(map) => scenario_image::figure_over(&scenario, self.occupied_areas(map, &scenario)?),
            None if self.is_plain => scenario_image::thumbnail(&scenario),
            None => scenario_image::figure(&scenario),
        };
        svg.map_err(|error| RunError::failed(Path::new(self.name), error))
    }

    fn only_for_levels(&self, kind: &str, flag: &str) -> RunError {
        let why = format!("is a {kind}, and {flag} is for level generators; help: leave it out");
        RunError::invalid_input(Path::new(self.name), why)
    }

    /// The contact sheet of a set: each scenario, and the first level of each level generator.
    fn sheet_of_set(&self, set: &ScenarioSet) -> Result<String, RunError> {
        let path = Path::new(self.name);
        let mut scenarios = Vec::new();
        for member in &set.members {
            let first = member.source.first().map_err(|error| RunError::invalid_input(path, error))?;
            let mut scenario = Scenario { name: member.name.clone(), ..first };
            self.settings.apply_to_scenario(&mut scenario)?;
            scenarios.push(scenario);
        }
        scenario_image::contact_sheet(&set.name, &scenarios).map_err(|error| RunError::failed(path, error))
    }

    /// The contact sheet of levels with consecutive seeds.
    fn contact_sheet(&self, generator: &LevelGenerator) -> Result<String, RunError> {
        let mut levels = Vec::new();
        for k in 0..self.levels.unwrap_or(DEFAULT_LEVELS) {
            let mut level = self.level(generator, k)?;
            self.settings.apply_to_scenario(&mut level)?;
            levels.push(level);
        }
        let sheet = scenario_image::contact_sheet(&generator.name, &levels);
        sheet.map_err(|error| RunError::failed(Path::new(self.name), error))
    }

    /// The level whose seed is `k` more than the user's `--seed`, which is 0 by default.
    fn level(&self, generator: &LevelGenerator, k: u64) -> Result<Scenario, RunError> {
        let level = generator.level(self.seed.unwrap_or(0).saturating_add(k));
        level.map_err(|error| RunError::invalid_input(Path::new(self.name), error))
    }

    /// The occupied areas of `map` that overlap the bounds of the enclosure of `scenario`, which was imported from it. They are
    /// in m, in the scenario's frame.
    fn occupied_areas(&self, map: &Path, scenario: &Scenario) -> Result<Vec<Vec<(f64, f64)>>, RunError> {
        let frame = Frame::find(&scenario.about).ok_or_else(|| {
            let why =
                "its `about` does not say where it lies in a map; help: import it from the map (--import)";
            RunError::invalid_input(Path::new(self.name), why)
        })?;
        let resolution_m = self.resolution_m;
        let backdrop = backdrop(map, &ImportOptions { resolution_m, ..ImportOptions::default() })?;
        let (low, high) = scenario.enclosure.bounds_m();
        let overlaps = |corners: &Vec<(f64, f64)>| {
            let any = |is_inside: &dyn Fn(&(f64, f64)) -> bool| corners.iter().any(is_inside);
            any(&|at| at.0 > f64::from(low.x))
                && any(&|at| at.0 < f64::from(high.x))
                && any(&|at| at.1 > f64::from(low.y))
                && any(&|at| at.1 < f64::from(high.y))
        };
        let in_scenario =
            |corners: &[DVec2; 4]| corners.map(|corner| frame.to_scenario(corner).into()).to_vec();
        Ok(backdrop.areas_m.iter().map(in_scenario).filter(overlaps).collect())
    }
}
