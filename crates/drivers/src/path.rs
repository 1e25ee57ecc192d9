//! Following a path: the point to steer for, and the motion that leads there.
//!
//! Source: R. C. Coulter, *Implementation of the pure pursuit path tracking algorithm*, Carnegie Mellon University,
//! CMU-RI-TR-92-01, 1992: the arc through a point at distance l that lies y to the side has the curvature 2 y / l^2.

use glam::Vec2;

use crate::robot::Robot;

/// The point of `path` to steer for: the last one that the robot `sees` within `lookahead_m` along the path after the point
/// nearest to `at_m`. If the robot sees none, the point after the nearest, or the end of the path.
pub(crate) fn point_ahead(
    path: &[Vec2],
    at_m: Vec2,
    lookahead_m: f32,
    sees: impl Fn(Vec2) -> bool,
) -> Option<Vec2> {
    let distance = |index: usize| (path[index] - at_m).length();
    let nearest = (0..path.len()).reduce(|best, k| if distance(k) < distance(best) { k } else { best })?;
    let mut chosen = path[(nearest + 1).min(path.len() - 1)];
    let mut along_m = 0.0;
    for ends in path[nearest..].windows(2) {
        along_m += (ends[1] - ends[0]).length();
        if along_m > lookahead_m {
            break;
        }
        if sees(ends[1]) {
            chosen = ends[1];
        }
    }
    Some(chosen)
}

/// The index of the motion of `robot` that pursues `point_m` (in its frame): the one closest to the arc through the point,
/// as fast as the largest turning rate allows. If the point is behind the robot, a turn in place towards it.
pub(crate) fn pursue(robot: &Robot, point_m: Vec2) -> usize {
    let (max_speed, max_turn) = (robot.max_forward_speed_m_s(), robot.max_turn_rad_s());
    let squared = point_m.length_squared();
    if squared == 0.0 {
        return robot.closest_motion(0.0, 0.0);
    }
    if point_m.x <= 0.0 {
        return robot.closest_motion(0.0, if point_m.y >= 0.0 { max_turn } else { -max_turn });
    }
    let curvature = 2.0 * point_m.y / squared;
    let speed = max_speed.min(max_turn / curvature.abs().max(1e-6));
    robot.closest_motion(speed, speed * curvature)
}

#[cfg(test)]
mod tests {
    use glam::vec2;
    use wayfield_scenario::{Motion, Scenario};

    use super::*;

    #[test]
    fn the_point_ahead_is_the_farthest_in_sight_within_the_distance() {
        let path: Vec<Vec2> = (0..10).map(|k| vec2(k as f32, 0.0)).collect();
        let at = vec2(2.2, 0.5);
        assert_eq!(point_ahead(&path, at, 3.5, |_| true), Some(vec2(5.0, 0.0)));
        assert_eq!(point_ahead(&path, at, 3.5, |point| point.x < 4.5), Some(vec2(4.0, 0.0)));
        assert_eq!(point_ahead(&path, at, 3.5, |_| false), Some(vec2(3.0, 0.0)), "the next one");
        assert_eq!(point_ahead(&path, vec2(20.0, 0.0), 3.5, |_| true), Some(vec2(9.0, 0.0)), "the end");
        assert_eq!(point_ahead(&[], at, 3.5, |_| true), None);
    }

    #[test]
    fn pure_pursuit_drives_the_arc_through_the_point() {
        let motions = [(0.15, 1.5), (0.15, 0.75), (0.15, 0.0), (0.0, -1.5), (0.0, 0.0)];
        let motions = motions.map(|(v_m_s, w_rad_s)| Motion { v_m_s, w_rad_s }).into();
        let robot = Robot { motions, ..Robot::of(&Scenario::default()) };
        assert_eq!(pursue(&robot, vec2(0.5, 0.0)), 2);
        // Radius l^2 / (2 y) = 0.2 m, so w = v / r = 0.75 rad/s.
        assert_eq!(pursue(&robot, vec2(0.2, 0.2)), 1);
        assert_eq!(pursue(&robot, vec2(-0.5, -0.1)), 3, "behind: turn in place");
        assert_eq!(pursue(&robot, Vec2::ZERO), 4, "there: stop");
    }
}
