//! The motions that the actions of a policy stand for.

use wayfield_policy::{ActionSet, MotionLimits};
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
        ActionSet::Relative(motions) => {
            let (v_m_s, w_rad_s) = motions[action].of(&motion_limits(robot));
            robot.steerable(Motion { v_m_s, w_rad_s })
        }
    }
}

/// The motions of `robot` that all actions of `set` stand for.
#[must_use]
pub fn action_motions(set: &ActionSet, robot: &Robot) -> Vec<Motion> {
    (0..set.len(robot.motions.len())).map(|action| action_motion(set, action, robot)).collect()
}
