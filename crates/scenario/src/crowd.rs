//! Pedestrians: obstacles that walk to goals and avoid each other, by ORCA.
//!
//! In: a [`Scenario`], and the robot. Out: a [`Crowd`], which is advanced control step by control step. Unlike the pose of any
//! other obstacle, that of a pedestrian is not a function of the step alone: each pose depends on the previous one.

use glam::Vec2;
use serde::{Deserialize, Serialize};
use wayfield_orca::{Avoidance, Disc, avoiding_velocity};

use super::limits::COORDINATE_M;
use super::nearest_points::nearest_points;
use super::schema::{Obstacle, ObstacleMotion, Scenario};

/// How far ahead pedestrians avoid collisions with each other, in s. This and the next three values are vita-epfl/CrowdNav's.
const TIME_HORIZON_S: f32 = 5.0;
/// The distance in m beyond which pedestrians ignore each other.
const NEIGHBOUR_DISTANCE_M: f32 = 10.0;
/// Maximum number of neighbours that a pedestrian avoids; the nearest ones count.
const MAX_NEIGHBOURS: usize = 10;
/// Margin that pedestrians add to all radii, in m.
const MARGIN_M: f32 = 0.01;
/// How far ahead pedestrians avoid collisions with walls and static obstacles, in s.
const STATIC_HORIZON_S: f32 = 1.0;
/// A pedestrian slows down before its last goal: it covers the remaining distance in no less than this time, in s.
const STOPPING_TIME_S: f32 = 1.0;
/// The largest coordinate of a pedestrian, in m: twice that of any wall. It also limits the velocity, in m/s.
const MAX_COORDINATE_M: f32 = 2.0 * *COORDINATE_M.end();

/// The pedestrians of a scenario, in the order of its obstacles. At the start of an episode, each stands at its
/// [`Obstacle::position_m`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Crowd(Vec<Pedestrian>);

/// The state of a pedestrian.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pedestrian {
    /// The index of the obstacle in [`Scenario::obstacles`].
    obstacle: u32,
    /// The index of the goal that it walks to; the number of goals stands for the starting position.
    next_goal: u32,
    /// Its position, in m.
    pub position_m: Vec2,
    /// Its velocity in the last step, in m/s; zero at the start of an episode.
    pub velocity_m_s: Vec2,
}

impl Crowd {
    /// The pedestrians of `scenario` at the start of an episode. Empty if no obstacle is a pedestrian.
    #[must_use]
    pub fn at_start(scenario: &Scenario) -> Self {
        let obstacles = scenario.obstacles.iter().enumerate();
        let pedestrians = obstacles.filter(|(_, obstacle)| obstacle.motion.is_pedestrian());
        let at_start = |(index, obstacle): (usize, &Obstacle)| Pedestrian {
            obstacle: u32::try_from(index).unwrap_or(u32::MAX),
            next_goal: 0,
            position_m: obstacle.position_m,
            velocity_m_s: Vec2::ZERO,
        };
        Self(pedestrians.map(at_start).collect())
    }

    /// Whether there are no pedestrians.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The pedestrian that is the obstacle with this index.
    #[must_use]
    pub fn pedestrian(&self, obstacle: usize) -> Option<&Pedestrian> {
        let found = self.0.binary_search_by_key(&obstacle, |pedestrian| pedestrian.obstacle as usize);
        found.ok().map(|k| &self.0[k])
    }

    /// Advances the pedestrians of `scenario` by one control step. `robot_m` is the robot's position, `robot_m_s` its velocity.
    pub fn advance(&mut self, scenario: &Scenario, (robot_m, robot_m_s): (Vec2, Vec2)) {
        let discs: Vec<Disc> = self.0.iter().map(|pedestrian| pedestrian.disc(scenario)).collect();
        let radius_m = scenario.robot.radius_m.max(scenario.keep_out_m()) + MARGIN_M;
        let robot = Disc { at_m: robot_m, velocity_m_s: robot_m_s, radius_m };
        for (own, pedestrian) in self.0.iter_mut().enumerate() {
            let others = discs.iter().enumerate().filter(|(other, _)| *other != own).map(|(_, disc)| *disc);
            let velocity_m_s = pedestrian.choose_velocity(scenario, &discs[own], others, robot);
            pedestrian.velocity_m_s = velocity_m_s;
            pedestrian.position_m += velocity_m_s * scenario.task.control_period_s;
        }
    }

    /// Moves each pedestrian by the difference between its starting positions in two versions of a scenario. All pedestrians
    /// restart from their starting positions if different obstacles are pedestrians now, or the state does not fit the new
    /// version.
    pub fn follow_change(&mut self, from: &Scenario, to: &Scenario) {
        let (before, after) = (Self::at_start(from), Self::at_start(to));
        if !self.fits(to) || before.0.len() != after.0.len() {
            *self = after;
            return;
        }
        for (pedestrian, (before, after)) in self.0.iter_mut().zip(before.0.iter().zip(&after.0)) {
            pedestrian.position_m += after.position_m - before.position_m;
        }
    }

    /// Whether this can be the state of the pedestrians of `scenario`.
    #[must_use]
    pub fn fits(&self, scenario: &Scenario) -> bool {
        let is_valid = |(pedestrian, start): (&Pedestrian, &Pedestrian)| {
            let Pedestrian { obstacle, next_goal, position_m, velocity_m_s } = *pedestrian;
            let walk = Walk::of(start.obstacle(scenario));
            let numbers = [position_m.x, position_m.y, velocity_m_s.x, velocity_m_s.y];
            obstacle == start.obstacle
                && walk.is_some_and(|walk| (next_goal as usize) < walk.goal_count())
                && numbers.iter().all(|number| number.abs() <= MAX_COORDINATE_M)
        };
        let start = Self::at_start(scenario);
        self.0.len() == start.0.len() && self.0.iter().zip(&start.0).all(is_valid)
    }
}

impl Pedestrian {
    fn obstacle<'a>(&self, scenario: &'a Scenario) -> &'a Obstacle {
        &scenario.obstacles[self.obstacle as usize]
    }

    fn disc(&self, scenario: &Scenario) -> Disc {
        let radius_m = self.obstacle(scenario).shape.bounding_radius_m() + MARGIN_M;
        Disc { at_m: self.position_m, velocity_m_s: self.velocity_m_s, radius_m }
    }

    /// The velocity of the next step. If the current goal is reached, moves on to the one after it.
    fn choose_velocity(
        &mut self,
        scenario: &Scenario,
        own: &Disc,
        others: impl Iterator<Item = Disc>,
        robot: Disc,
    ) -> Vec2 {
        let Some(walk) = Walk::of(self.obstacle(scenario)) else { return Vec2::ZERO };
        let period_s = scenario.task.control_period_s;
        let arrival_m = own.radius_m.max(walk.speed_m_s * period_s);
        if (walk.goal_m(self.next_goal) - own.at_m).length() < arrival_m {
            self.next_goal = walk.after(self.next_goal);
        }
        let reach_m = own.radius_m + walk.speed_m_s * STATIC_HORIZON_S;
        let avoidance = Avoidance {
            discs: &neighbours(own, others.chain(walk.sees_robot.then_some(robot))),
            points_m: &nearest_points(scenario, own.at_m, reach_m),
            time_horizon_s: TIME_HORIZON_S,
            static_horizon_s: STATIC_HORIZON_S,
            responsibility: 0.5,
            period_s,
        };
        let preferred_m_s = walk.velocity_towards(self.next_goal, own.at_m);
        avoiding_velocity(own, preferred_m_s, walk.speed_m_s, &avoidance)
    }
}

/// The motion of a pedestrian.
struct Walk<'a> {
    start_m: Vec2,
    goals_m: &'a [Vec2],
    speed_m_s: f32,
    loops: bool,
    sees_robot: bool,
}

impl<'a> Walk<'a> {
    /// The motion of `obstacle`; `None` if it is not a pedestrian.
    fn of(obstacle: &'a Obstacle) -> Option<Self> {
        match &obstacle.motion {
            &ObstacleMotion::Pedestrian { ref goals_m, speed_m_s, loops, sees_robot } => {
                let (start_m, speed_m_s) = (obstacle.position_m, speed_m_s.value());
                Some(Self { start_m, goals_m, speed_m_s, loops, sees_robot })
            }
            _ => None,
        }
    }

    /// The number of goals, including the starting position if the pedestrian returns there.
    fn goal_count(&self) -> usize {
        self.goals_m.len() + usize::from(self.loops)
    }

    fn goal_m(&self, goal: u32) -> Vec2 {
        self.goals_m.get(goal as usize).copied().unwrap_or(self.start_m)
    }

    fn is_last(&self, goal: u32) -> bool {
        goal as usize + 1 >= self.goal_count()
    }

    /// The goal after `goal`.
    fn after(&self, goal: u32) -> u32 {
        match (self.is_last(goal), self.loops) {
            (false, _) => goal + 1,
            (true, true) => 0,
            (true, false) => goal,
        }
    }

    /// The velocity in m/s from `at_m` towards `goal`, if nothing is in the way.
    fn velocity_towards(&self, goal: u32, at_m: Vec2) -> Vec2 {
        let to_goal_m = self.goal_m(goal) - at_m;
        if self.is_last(goal) && !self.loops {
            (to_goal_m / STOPPING_TIME_S).clamp_length_max(self.speed_m_s)
        } else {
            to_goal_m.normalize_or_zero() * self.speed_m_s
        }
    }
}

/// The nearest of `others`, nearest first.
fn neighbours(own: &Disc, others: impl Iterator<Item = Disc>) -> Vec<Disc> {
    let away = |disc: &Disc| (disc.at_m - own.at_m).length_squared();
    let mut near: Vec<Disc> =
        others.filter(|disc| away(disc) < NEIGHBOUR_DISTANCE_M * NEIGHBOUR_DISTANCE_M).collect();
    near.sort_by(|a, b| away(a).total_cmp(&away(b)));
    near.truncate(MAX_NEIGHBOURS);
    near
}
