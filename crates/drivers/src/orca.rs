//! Optimal reciprocal collision avoidance: the velocity closest to the wanted one that collides with nothing for some time.
//!
//! Source: J. van den Berg, S. J. Guy, M. Lin and D. Manocha, *Reciprocal n-body collision avoidance*, Robotics Research, STAR 70,
//! Springer 2011. Each disc allows a half plane of velocities (section 4); walls and static obstacles allow those that do not
//! reach their nearest point in time (section 5.4, for a current velocity of zero). The best velocity is found by a linear
//! program in two dimensions; if there is none, the one that violates the half planes of the discs least.
//!
//! (The crate `dodgy_2d` is a port of the authors' RVO2. It draws random numbers, and brings second versions of glam and rand,
//! one of which does not build for browsers.)

mod half_plane;

use glam::{Vec2, vec2};
use wayfield_scenario::{
    Obstacle, ObstacleMotion, Scenario, Wall, enclosure_distance, pose_at, shape_distance,
};

use crate::Driver;
use crate::config::OrcaParameters;
use crate::percept::{Odometry, Percept, Truth};
use crate::robot::Robot;
use half_plane::{HalfPlane, best_velocity};

/// A disc that moves at constant velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    /// Its centre, in m.
    pub at_m: Vec2,
    /// Its velocity, in m/s.
    pub velocity_m_s: Vec2,
    /// Its radius, in m.
    pub radius_m: f32,
}

/// What an agent avoids, and how.
#[derive(Clone, Copy, Debug)]
pub struct Avoidance<'a> {
    /// The other discs.
    pub discs: &'a [Disc],
    /// The nearest points of walls and static obstacles, in m.
    pub points_m: &'a [Vec2],
    /// Time for which no collision with discs is allowed, in s.
    pub time_horizon_s: f32,
    /// The same for points, in s.
    pub static_horizon_s: f32,
    /// The agent's share of the avoidance, 0 to 1.
    pub responsibility: f32,
    /// Time in which a collision that has happened is to end, in s.
    pub period_s: f32,
}

/// The velocity of `agent`, in m/s, that is closest to `wanted_m_s`, at most `max_speed_m_s` fast, and avoids the others.
#[must_use]
pub fn avoiding_velocity(agent: &Disc, wanted_m_s: Vec2, max_speed_m_s: f32, avoidance: &Avoidance) -> Vec2 {
    let point = |point_m: &Vec2| HalfPlane::before_point(agent, *point_m, avoidance.static_horizon_s);
    let disc = |other: &Disc| HalfPlane::beside_disc(agent, other, avoidance);
    let mut planes: Vec<HalfPlane> = avoidance.points_m.iter().map(point).collect();
    let fixed = planes.len();
    planes.extend(avoidance.discs.iter().map(disc));
    best_velocity(&planes, fixed, wanted_m_s, max_speed_m_s)
}

/// A robot that is told the true poses and velocities.
pub(crate) struct OrcaDriver {
    pub(crate) robot: Robot,
    pub(crate) parameters: OrcaParameters,
}

impl Driver for OrcaDriver {
    fn act(&mut self, percept: &Percept) -> usize {
        let Some(truth) = &percept.truth else { return 0 };
        let OrcaParameters { time_horizon_s, static_horizon_s, responsibility, margin, turn_time_s } =
            self.parameters;
        let (x, y, rotation_rad) = truth.pose;
        let frame = Odometry { translation_m: Vec2::ZERO, rotation_rad };
        let max_speed = self.robot.max_speed_m_s();
        let agent = Disc {
            at_m: vec2(x, y),
            velocity_m_s: frame.to_outer(vec2(percept.twist.v_m_s, 0.0)),
            radius_m: self.robot.keep_out_m * (1.0 + margin),
        };
        let to_goal = truth.goal_m - agent.at_m;
        let wanted = to_goal.normalize_or_zero() * max_speed;
        let reach_m = agent.radius_m + max_speed * static_horizon_s;
        let avoidance = Avoidance {
            discs: &discs(truth, self.robot.control_period_s),
            points_m: &nearest_points(truth.scenario, agent.at_m, reach_m),
            time_horizon_s,
            static_horizon_s,
            responsibility,
            period_s: self.robot.control_period_s,
        };
        let velocity = avoiding_velocity(&agent, wanted, max_speed, &avoidance);
        self.robot.motion_towards(frame.to_inner(velocity), turn_time_s)
    }
}

/// The moving obstacles as discs, with their velocities over the next step.
fn discs(truth: &Truth, period_s: f32) -> Vec<Disc> {
    let disc = |obstacle: &Obstacle| {
        let (x, y, _) = pose_at(obstacle, truth.clock, period_s);
        let (next_x, next_y, _) = pose_at(obstacle, truth.clock + 1, period_s);
        Disc {
            at_m: vec2(x, y),
            velocity_m_s: vec2(next_x - x, next_y - y) / period_s,
            radius_m: obstacle.shape.bounding_radius_m(),
        }
    };
    truth.scenario.obstacles.iter().filter(|o| o.motion != ObstacleMotion::Static).map(disc).collect()
}

/// The nearest point of each wall and static obstacle within `reach_m` of `at_m`.
fn nearest_points(scenario: &Scenario, at_m: Vec2, reach_m: f32) -> Vec<Vec2> {
    let period_s = scenario.task.control_period_s;
    let is_static = |obstacle: &&Obstacle| obstacle.motion == ObstacleMotion::Static;
    let solids = scenario.obstacles.iter().filter(is_static).cloned();
    let solids = solids.chain(scenario.walls.iter().flat_map(Wall::segments));
    let of_solid = |obstacle: Obstacle| {
        let pose = pose_at(&obstacle, 0, period_s);
        nearest_point(at_m, reach_m, |point| shape_distance(&obstacle.shape, pose, point))
    };
    let corners = scenario.enclosure.corners_m();
    let sides = corners.iter().zip(corners.iter().cycle().skip(1)).filter_map(|(&from, &to)| {
        let nearest = nearest_on_segment(from, to, at_m);
        ((nearest - at_m).length() <= reach_m).then_some(nearest)
    });
    let inside = enclosure_distance(&scenario.enclosure, at_m) > 0.0;
    solids.filter_map(of_solid).chain(sides.filter(|_| inside)).collect()
}

/// The nearest point of a convex solid within `reach_m` of `at_m`, from the signed distance to it and its gradient.
fn nearest_point(at_m: Vec2, reach_m: f32, distance: impl Fn(Vec2) -> f32) -> Option<Vec2> {
    const STEP_M: f32 = 1e-3;
    let away_m = distance(at_m);
    if away_m > reach_m {
        return None;
    }
    let slope = |step: Vec2| distance(at_m + step) - distance(at_m - step);
    let outwards = vec2(slope(Vec2::X * STEP_M), slope(Vec2::Y * STEP_M)).normalize_or_zero();
    Some(at_m - outwards * away_m.max(0.0))
}

fn nearest_on_segment(from: Vec2, to: Vec2, point: Vec2) -> Vec2 {
    let way = to - from;
    let part = (point - from).dot(way) / way.length_squared().max(f32::MIN_POSITIVE);
    from + way * part.clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use wayfield_scenario::Shape;

    use super::*;

    fn avoidance<'a>(discs: &'a [Disc], points_m: &'a [Vec2]) -> Avoidance<'a> {
        Avoidance {
            discs,
            points_m,
            time_horizon_s: 5.0,
            static_horizon_s: 1.0,
            responsibility: 0.5,
            period_s: 0.25,
        }
    }

    #[test]
    fn a_wall_ahead_allows_the_speed_that_reaches_it_after_the_horizon() {
        let agent = Disc { at_m: Vec2::ZERO, velocity_m_s: Vec2::ZERO, radius_m: 0.3 };
        // 0.5 m of free way in 1 s.
        let velocity = avoiding_velocity(&agent, vec2(1.0, 0.0), 1.0, &avoidance(&[], &[vec2(0.8, 0.0)]));
        assert!((velocity - vec2(0.5, 0.0)).length() < 1e-5, "{velocity}");
        let free = avoiding_velocity(&agent, vec2(0.0, 1.0), 1.0, &avoidance(&[], &[vec2(0.8, 0.0)]));
        assert_eq!(free, vec2(0.0, 1.0), "along the wall, nothing changes");
    }

    #[test]
    fn two_agents_that_meet_head_on_pass_each_other_symmetrically() {
        let mut agents = [
            Disc { at_m: vec2(-2.0, 0.001), velocity_m_s: vec2(1.0, 0.0), radius_m: 0.3 },
            Disc { at_m: vec2(2.0, -0.001), velocity_m_s: vec2(-1.0, 0.0), radius_m: 0.3 },
        ];
        let mut least_m = f32::INFINITY;
        for _ in 0..24 {
            let velocities = [0, 1].map(|own| {
                let wanted = if own == 0 { vec2(1.0, 0.0) } else { vec2(-1.0, 0.0) };
                avoiding_velocity(&agents[own], wanted, 1.0, &avoidance(&[agents[1 - own]], &[]))
            });
            assert!((velocities[0] + velocities[1]).length() < 1e-3, "mirrored: {velocities:?}");
            for (agent, velocity) in agents.iter_mut().zip(velocities) {
                agent.velocity_m_s = velocity;
                agent.at_m += velocity * 0.25;
            }
            least_m = least_m.min((agents[0].at_m - agents[1].at_m).length());
        }
        assert!(agents[0].at_m.x > 1.0, "they have passed: {agents:?}");
        assert!(least_m > 0.599 && least_m < 0.7, "without touching and without a detour: {least_m} m");
    }

    #[test]
    fn the_nearest_points_of_walls_and_obstacles_are_those_worked_out_by_hand() {
        let scenario = Scenario {
            walls: vec![Wall { corners_m: vec![vec2(-1.0, -1.0), vec2(1.0, -1.0)], thickness_m: 0.2 }],
            obstacles: vec![Obstacle {
                shape: Shape::Circle { radius_m: 0.2 },
                position_m: vec2(0.6, 0.8),
                rotation_rad: 0.0,
                motion: ObstacleMotion::Static,
            }],
            ..Scenario::default()
        };
        let points = nearest_points(&scenario, Vec2::ZERO, 1.5);
        let expected = [vec2(0.48, 0.64), vec2(0.0, -0.9)];
        assert_eq!(points.len(), 2, "the enclosure is 2 m away: {points:?}");
        for (point, expected) in points.iter().zip(expected) {
            assert!((*point - expected).length() < 2e-3, "{point}, not {expected}");
        }
    }
}
