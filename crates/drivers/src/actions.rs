//! The motions that the actions of a policy stand for.

use wayfield_policy::{ActionSet, MotionLimits, RelativeMotion};
use wayfield_scenario::{Motion, Robot};

/// The limits of the motions of `robot`.
#[must_use]
pub fn motion_limits(robot: &Robot) -> MotionLimits {
    let (low, high) = robot.motion_limits();
    MotionLimits { v_m_s: (low.v_m_s, high.v_m_s), w_rad_s: (low.w_rad_s, high.w_rad_s) }
}

/// The motion of `robot` that `action` of `set` stands for.
///
/// # Panics
/// There is no such action.
#[must_use]
pub fn action_motion(set: &ActionSet, action: usize, robot: &Robot) -> Motion {
    match set {
        ActionSet::Robot => robot.motions[action],
        ActionSet::Relative(motions) => relative_motion(motions[action], robot, &motion_limits(robot)),
    }
}

/// The motion of `robot` that `relative` stands for. `limits` are the robot's [`motion_limits`].
#[must_use]
pub fn relative_motion(relative: RelativeMotion, robot: &Robot, limits: &MotionLimits) -> Motion {
    let (v_m_s, w_rad_s) = relative.of(limits);
    robot.steerable(Motion { v_m_s, w_rad_s })
}

/// The motions of `robot` that all actions of `set` stand for.
#[must_use]
pub fn action_motions(set: &ActionSet, robot: &Robot) -> Vec<Motion> {
    match set {
        ActionSet::Robot => robot.motions.clone(),
        ActionSet::Relative(motions) => {
            let limits = motion_limits(robot);
            motions.iter().map(|&relative| relative_motion(relative, robot, &limits)).collect()
        }
    }
}
