//! The memory check of a training run.
//!
//! A valid preset and a valid scenario can still need too much memory together.

use super::preset::Preset;
use crate::learning::limits::MAX_STORED_FLOATS;
use crate::limits::{MAX_BODIES, MAX_OBSERVED_FLOATS};
use crate::scenario::{Scenario, Wall};
use crate::task::{ObservationLayout, observation};

/// Maximum number of bodies in one arena of `scenario`: the robot, wall segments and obstacles.
#[must_use]
pub fn bodies_per_arena(scenario: &Scenario) -> usize {
    let segments: usize = scenario.walls.iter().map(Wall::piece_count).sum();
    1 + segments + scenario.max_obstacles()
}

impl Preset {
    /// Checks that a training run with this preset in `scenario`, with observations of `layout`, needs no more memory than
    /// allowed.
    ///
    /// # Errors
    /// The run needs too much memory. The message names the fields to reduce.
    pub fn check_memory(&self, scenario: &Scenario, layout: &ObservationLayout) -> Result<(), String> {
        self.check_env_memory(scenario, layout)?;
        self.check_replay(scenario, layout)
    }

    /// Checks that the preset's arenas in `scenario`, without a learner, need no more memory than allowed.
    ///
    /// # Errors
    /// They need too much memory. The message names the fields to reduce.
    pub fn check_env_memory(&self, scenario: &Scenario, layout: &ObservationLayout) -> Result<(), String> {
        self.check_bodies(scenario)?;
        self.check_observations(scenario, layout)
    }

    fn check_bodies(&self, scenario: &Scenario) -> Result<(), String> {
        let arenas = self.arenas;
        let bodies = bodies_per_arena(scenario).saturating_mul(arenas);
        if bodies <= MAX_BODIES {
            return Ok(());
        }
        Err(format!(
            "{arenas} arenas of this scenario have {bodies} bodies, more than {MAX_BODIES}; help: use fewer `arenas`, or a \
             scenario with fewer obstacles and walls"
        ))
    }

    fn check_observations(&self, scenario: &Scenario, layout: &ObservationLayout) -> Result<(), String> {
        let (arenas, lidar) = (self.arenas, &scenario.lidar);
        let [_, latency_steps] = lidar.latency_steps.ends();
        // The scan that the robot receives, and the last `latency_steps` + 1 scans. To these are added the current observation, the
        // next one, and the sensors' readings.
        let scans = (latency_steps as usize + 2) * observation::width(lidar.beams);
        let floats_per_arena = layout
            .width(lidar.beams)
            .saturating_mul(2)
            .saturating_add(layout.extra_width())
            .saturating_add(scans);
        let floats = arenas.saturating_mul(floats_per_arena);
        if floats <= MAX_OBSERVED_FLOATS {
            return Ok(());
        }
        Err(format!(
            "the scans and observations of {arenas} arenas with {} beams, a latency of {} steps and {} values from plugins' \
             sensors have {floats} floats, more than {MAX_OBSERVED_FLOATS}; help: use fewer `arenas`, `lidar.beams` or \
             `lidar.latency_steps`",
            lidar.beams,
            latency_steps,
            layout.extra_width()
        ))
    }

    /// Number of observations that the learner stores: one per transition in the replay buffer, and those of the transitions that
    /// are not yet complete. The eighth that the replay buffer allocates beyond its capacity is not counted.
    pub(super) fn stored_states(&self) -> usize {
        self.learning.replay.capacity + self.arenas * (self.learning.n_step + 1)
    }

    fn check_replay(&self, scenario: &Scenario, layout: &ObservationLayout) -> Result<(), String> {
        let width = layout.width(scenario.lidar.beams);
        let states = self.stored_states();
        let floats = states.saturating_mul(width);
        if floats <= MAX_STORED_FLOATS {
            return Ok(());
        }
        Err(format!(
            "the replay buffer would store {states} states of {width} floats, {floats} in all, more than \
             {MAX_STORED_FLOATS}; help: reduce `learning.replay.capacity`, `arenas` or `lidar.beams`"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::limits::MAX_ARENAS;
    use crate::run::shipped;
    use crate::task::{Encoding, ObservationSlice};

    fn fast() -> Preset {
        shipped::preset("fast").expect("shipped")
    }

    /// Asserts that the preset `fast` with `change` needs too much memory in `scenario`, and that the message
    /// names `field`.
    fn assert_too_large(scenario: &Scenario, change: fn(&mut Preset), field: &str) {
        let mut preset = fast();
        change(&mut preset);
        let error = preset.check_memory(scenario, &ObservationLayout::default()).expect_err(field);
        assert!(error.contains(field), "{error}");
    }

    #[test]
    fn every_shipped_scenario_fits_with_the_maximum_number_of_arenas() {
        let preset = Preset { arenas: MAX_ARENAS, ..fast() };
        for (name, scenario) in shipped::scenarios() {
            assert_eq!(preset.check_memory(&scenario, &ObservationLayout::default()), Ok(()), "{name}");
        }
    }

    #[test]
    fn a_run_that_needs_too_much_memory_is_rejected_with_the_field_to_reduce() {
        let obstacle = shipped::scenario("crowd").expect("shipped").obstacles[0].clone();
        let crowd = Scenario { obstacles: vec![obstacle; 10_000], ..Scenario::default() };
        // 16 arenas with 10,000 obstacles each have 160,016 bodies; 100 arenas have 1,000,100.
        let fits = Preset { arenas: 16, ..fast() }.check_memory(&crowd, &ObservationLayout::default());
        assert_eq!(fits, Ok(()));
        assert_too_large(&crowd, |preset| preset.arenas = 100, "`arenas`");

        let mut many_beams = shipped::scenario("empty").expect("shipped");
        (many_beams.lidar.beams, many_beams.lidar.latency_steps) = (4096, 50.into());
        assert_too_large(&many_beams, |preset| preset.arenas = 4096, "`lidar.latency_steps`");
        // 2^19 states of 4,100 floats: 2.1e9.
        let large_replay = |preset: &mut Preset| preset.learning.replay.capacity = 1 << 19;
        assert_too_large(&many_beams, large_replay, "`learning.replay.capacity`");
    }

    #[test]
    fn the_sensors_of_plugins_count_towards_the_limits() {
        let scenario = shipped::scenario("empty").expect("shipped");
        // 400,048 states of 28 + 1,000 numbers each fit (4.1e8); with 28 + 6,000 they do not (2.4e9).
        let layout = |width| {
            let camera = ObservationSlice { name: "camera".into(), width };
            ObservationLayout::new(Encoding::Scaled, vec![camera])
        };
        assert_eq!(fast().check_memory(&scenario, &layout(1_000)), Ok(()));
        let error = fast().check_memory(&scenario, &layout(6_000)).expect_err("too much");
        assert!(error.contains("of 6028 floats") && error.contains("`learning.replay.capacity`"), "{error}");
        // 4096 arenas with 3 x 30,000 numbers each: 3.7e8.
        let many = Preset { arenas: MAX_ARENAS, ..fast() };
        let error = many.check_memory(&scenario, &layout(30_000)).expect_err("too much");
        assert!(
            error.contains("30000 values from plugins' sensors") && error.contains("`arenas`"),
            "{error}"
        );
    }
}
