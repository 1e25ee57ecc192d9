//! The mirror image of a run's observations and actions, left for right, for mirror augmentation (`learning.mirror`).
//!
//! In: a run's configuration. Out: a [`Mirror`] for its learner, or the reason why there is none.

use super::RunError;
use super::folder::RunConfig;
use crate::learning::Mirror;
use crate::policy::ActionSet;
use crate::scenario::Motion;
use crate::task::Encoding;

/// Why a preset with `learning.mirror` and this encoding of observations is rejected; `None` if these can be mirrored.
#[must_use]
pub(crate) fn problem_of(encoding: Encoding) -> Option<&'static str> {
    encoding.sectors().is_none().then_some(
        "is true, but `observation` contains the index of the nearest beam, which has no mirror image; help: use \
         `observation: Sectors(...)`, or `mirror: false`",
    )
}

/// The mirror of a run; `None` if its preset does not have `learning.mirror`.
///
/// # Errors
/// The observations or the actions have no mirror image.
pub(crate) fn of_run(config: &RunConfig) -> Result<Option<Mirror>, RunError> {
    if !config.preset.learning.mirror {
        return Ok(None);
    }
    let fail =
        |why: String| RunError::InvalidInput(format!("{}: `learning.mirror` {why}", config.preset_from));
    if let Some(sensor) = config.sensors.first() {
        return Err(fail(format!(
            "is true, but the mirror image of the plugin sensor `{}` is unknown; help: use `mirror: false`",
            sensor.name
        )));
    }
    let Some(sectors) = config.preset.observation.sectors() else {
        return Err(fail(problem_of(config.preset.observation).unwrap_or_default().into()));
    };
    let inputs = sectors.mirrored_columns().into_iter().map(|(from, sign)| (from as u32, sign)).collect();
    let motions: Vec<Motion> = match &config.preset.actions {
        ActionSet::Robot => config.scenario.robot.motions.clone(),
        ActionSet::Relative(motions) => {
            motions.iter().map(|motion| Motion { v_m_s: motion.speed, w_rad_s: motion.turn }).collect()
        }
    };
    let actions = actions(&motions).map_err(|Motion { v_m_s, w_rad_s }| {
        fail(format!(
            "is true, but the robot of scenario \"{}\" has no motion (v_m_s: {v_m_s:?}, w_rad_s: {:?}), the mirror image of \
             (v_m_s: {v_m_s:?}, w_rad_s: {w_rad_s:?}); help: add it to `robot.motions`, or use `mirror: false`",
            config.scenario.name, -w_rad_s
        ))
    })?;
    Mirror::new(inputs, actions).map(Some).map_err(|error| fail(format!("is true, but {error}")))
}

/// For each motion, the index of the one that turns as fast to the other side. Of equal motions, the first mirrors the first,
/// the second the second.
///
/// # Errors
/// A motion has no mirror image.
fn actions(motions: &[Motion]) -> Result<Vec<u32>, Motion> {
    let image = |(k, motion): (usize, &Motion)| {
        let earlier = motions[..k].iter().filter(|other| *other == motion).count();
        let is_image = |other: &Motion| other.v_m_s == motion.v_m_s && other.w_rad_s == -motion.w_rad_s;
        let images = motions.iter().enumerate().filter(|(_, other)| is_image(other));
        images.map(|(index, _)| index as u32).nth(earlier).ok_or(*motion)
    };
    motions.iter().enumerate().map(image).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::preset::Preset;
    use crate::scenario::Scenario;

    fn motions(motions: &[(f32, f32)]) -> Vec<Motion> {
        motions.iter().map(|&(v_m_s, w_rad_s)| Motion { v_m_s, w_rad_s }).collect()
    }

    #[test]
    fn the_mirror_image_of_an_action_turns_to_the_other_side_at_the_same_speed() {
        assert_eq!(actions(&Scenario::default().robot.motions), Ok(vec![4, 3, 2, 1, 0]), "the paper's five");
        let rich = motions(&[(0.0, 0.0), (0.1, 1.0), (0.2, 1.0), (0.1, -1.0), (0.2, -1.0), (0.1, -0.0)]);
        assert_eq!(actions(&rich), Ok(vec![0, 3, 4, 1, 2, 5]));
        let twice = motions(&[(0.1, 1.0), (0.1, 1.0), (0.1, -1.0), (0.1, -1.0), (0.1, 0.0), (0.1, 0.0)]);
        assert_eq!(actions(&twice), Ok(vec![2, 3, 0, 1, 4, 5]));
        let one_sided = motions(&[(0.1, 1.0), (0.2, -1.0), (0.1, 0.0)]);
        assert_eq!(actions(&one_sided), Err(Motion { v_m_s: 0.1, w_rad_s: 1.0 }));
    }

    #[test]
    fn a_run_whose_observation_has_no_mirror_image_is_rejected_with_the_fix() {
        let mut preset = Preset::default();
        let scenario = || ("empty".into(), Scenario::default());
        let of = |preset: &Preset| of_run(&RunConfig::new(scenario(), ("mine".into(), preset.clone()), 0));
        assert!(matches!(of(&preset), Ok(None)), "without the switch there is no mirror");
        preset.learning.mirror = true;
        let error = of(&preset).expect_err("the index of the nearest beam").to_string();
        assert!(error.starts_with("mine: `learning.mirror` is true") && error.contains("help: "), "{error}");
    }
}
