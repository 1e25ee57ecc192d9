//! The mirror image of a run's observations and actions, left and right swapped, for mirror augmentation (`learning.mirror`).
//!
//! In: a run's configuration. Out: a [`Mirror`] for its learner, or the reason why there is none.

use super::RunError;
use super::folder::RunConfig;
use crate::learning::Mirror;
use crate::policy::{ActionSet, RelativeMotion};
use crate::scenario::Motion;
use crate::task::{ActiveActionSet, Encoding};

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
    let images = images(&config.preset.actions, &config.scenario.robot.motions).map_err(&fail)?;
    let members = config.scenario_set.iter().flat_map(|set| &set.members);
    let members = members.map(|member| (&member.name, member.source.task().0));
    for (name, robot) in members.chain([(&config.scenario.name, &config.scenario.robot)]) {
        let motions = ActiveActionSet(config.preset.actions.clone()).motions(robot);
        if motions.iter().zip(&images).any(|(motion, &image)| !is_image(motion, &motions[image as usize])) {
            let (low, high) = robot.motion_limits();
            return Err(fail(format!(
                "is true, but the robot of \"{name}\" turns at up to {:?} rad/s to the left and {:?} rad/s to the right; help: \
                 change its `robot.motions` so that both are equal, or use `mirror: false`",
                high.w_rad_s,
                low.w_rad_s.abs()
            )));
        }
    }
    Mirror::new(inputs, images).map(Some).map_err(|error| fail(format!("is true, but {error}")))
}

/// For each action, the index of its mirror image.
///
/// # Errors
/// An action has no mirror image.
fn images(actions: &ActionSet, of_robot: &[Motion]) -> Result<Vec<u32>, String> {
    let relative: Vec<Motion>;
    let (motions, list, [speed, turn]) = match actions {
        ActionSet::Robot => (of_robot, "robot.motions", ["v_m_s", "w_rad_s"]),
        ActionSet::Relative(motions) => {
            let motion = |motion: &RelativeMotion| Motion { v_m_s: motion.speed, w_rad_s: motion.turn };
            relative = motions.iter().map(motion).collect();
            (&relative[..], "actions", ["speed", "turn"])
        }
    };
    images_of(motions).map_err(|Motion { v_m_s, w_rad_s }| {
        format!(
            "is true, but `{list}` lacks ({speed}: {v_m_s:?}, {turn}: {:?}), the mirror image of ({speed}: {v_m_s:?}, {turn}: \
             {w_rad_s:?}); help: add it, or use `mirror: false`",
            -w_rad_s
        )
    })
}

fn is_image(one: &Motion, other: &Motion) -> bool {
    one.v_m_s == other.v_m_s && one.w_rad_s == -other.w_rad_s
}

/// For each motion, the index of its mirror image: the motion that turns equally fast to the other side. If a motion is listed
/// several times, its first entry mirrors the first entry of its image, the second the second, and so on.
///
/// # Errors
/// A motion has no mirror image.
fn images_of(motions: &[Motion]) -> Result<Vec<u32>, Motion> {
    let image = |(k, motion): (usize, &Motion)| {
        let earlier = motions[..k].iter().filter(|other| *other == motion).count();
        let images = motions.iter().enumerate().filter(|(_, other)| is_image(motion, other));
        images.map(|(index, _)| index as u32).nth(earlier).ok_or(*motion)
    };
    motions.iter().enumerate().map(image).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::preset::Preset;
    use crate::scenario::Scenario;
    use crate::task::ObservationSlice;

    fn motions(motions: &[(f32, f32)]) -> Vec<Motion> {
        motions.iter().map(|&(v_m_s, w_rad_s)| Motion { v_m_s, w_rad_s }).collect()
    }

    #[test]
    fn the_mirror_image_of_an_action_turns_to_the_other_side_at_the_same_speed() {
        assert_eq!(
            images_of(&Scenario::default().robot.motions),
            Ok(vec![4, 3, 2, 1, 0]),
            "the paper's five"
        );
        let rich = motions(&[(0.0, 0.0), (0.1, 1.0), (0.2, 1.0), (0.1, -1.0), (0.2, -1.0), (0.1, -0.0)]);
        assert_eq!(images_of(&rich), Ok(vec![0, 3, 4, 1, 2, 5]));
        let twice = motions(&[(0.1, 1.0), (0.1, 1.0), (0.1, -1.0), (0.1, -1.0), (0.1, 0.0), (0.1, 0.0)]);
        assert_eq!(images_of(&twice), Ok(vec![2, 3, 0, 1, 4, 5]));
        let one_sided = motions(&[(0.1, 1.0), (0.2, -1.0), (0.1, 0.0)]);
        assert_eq!(images_of(&one_sided), Err(Motion { v_m_s: 0.1, w_rad_s: 1.0 }));
    }

    /// The mirror of a run in an empty arena with these relative motions and a robot with these turning rates at full speed;
    /// or the error.
    fn mirror(relative: &[(f32, f32)], turns: &[f32]) -> Result<Mirror, String> {
        let mut preset = Preset {
            observation: Encoding::Sectors {
                count: 4,
                earlier_steps: 1,
                free_paths: false,
                predicted_paths: true,
            },
            actions: ActionSet::Relative(
                relative.iter().map(|&(speed, turn)| RelativeMotion { speed, turn }).collect(),
            ),
            ..Preset::default()
        };
        preset.learning.mirror = true;
        let mut scenario = Scenario::default();
        scenario.robot.motions = turns.iter().map(|&w_rad_s| Motion { v_m_s: 0.5, w_rad_s }).collect();
        let run = RunConfig::new(("empty".into(), scenario), ("mine".into(), preset), 0);
        of_run(&run).map(|mirror| mirror.expect("the preset has it")).map_err(|error| error.to_string())
    }

    #[test]
    fn sectors_and_relative_motions_are_mirrored() {
        let found = mirror(&[(1.0, 0.5), (1.0, 0.0), (1.0, -0.5)], &[-1.0, 1.0]);
        // Ahead, left, behind, right; their changes; their predicted paths; the goal's cosine, sine, nearness and distance; speed
        // and turning rate; two lengths of the robot; waiting.
        let from = [0, 3, 2, 1, 4, 7, 6, 5, 8, 11, 10, 9, 12, 13, 14, 15, 16, 17, 18, 19, 20];
        let sign = |k| if k == 13 || k == 17 { -1.0 } else { 1.0 };
        let inputs = from.into_iter().map(|k| (k, sign(k))).collect();
        assert_eq!(found, Ok(Mirror::new(inputs, vec![2, 1, 0]).expect("an involution")));
    }

    #[test]
    fn motions_without_a_mirror_image_are_rejected_with_the_fix() {
        let error = mirror(&[(1.0, 0.5), (1.0, 0.0)], &[-1.0, 1.0]).expect_err("only to the left");
        let expected =
            "`actions` lacks (speed: 1.0, turn: -0.5), the mirror image of (speed: 1.0, turn: 0.5); help: ";
        assert!(error.contains(expected), "{error}");
        let error = mirror(&[(1.0, 0.5), (1.0, -0.5)], &[-1.0, 2.0]).expect_err("faster to the left");
        let expected = "turns at up to 2.0 rad/s to the left and 1.0 rad/s to the right; help: ";
        assert!(error.contains(expected), "{error}");
    }

    #[test]
    fn the_mirror_image_of_a_plugin_sensor_is_unknown() {
        let mut preset = Preset {
            observation: Encoding::Sectors {
                count: 4,
                earlier_steps: 0,
                free_paths: false,
                predicted_paths: false,
            },
            ..Preset::default()
        };
        preset.learning.mirror = true;
        let mut run = RunConfig::new(("empty".into(), Scenario::default()), ("mine".into(), preset), 0);
        assert!(matches!(of_run(&run), Ok(Some(_))));
        run.sensors = vec![ObservationSlice { name: "bumper".into(), width: 1 }];
        let error = of_run(&run).expect_err("a plugin's sensor").to_string();
        assert!(error.contains("the plugin sensor `bumper` is unknown; help: "), "{error}");
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
