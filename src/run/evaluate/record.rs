//! The records of an evaluation's episodes: one row each in the file of `--eval --csv`.

use serde::Serialize;

use super::{EpisodeResult, outcome_name, period_s, round_to_millionth};
use crate::planner::StepBounds;
use crate::scenario::{Obstacle, ObstacleMotion, Scenario, Shape, Solid};

/// The record of one episode: what happened, how long it took, how long the path was, and how close the robot came to walls and
/// obstacles. The field names are the columns of the file; an empty field is unknown or does not apply.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EpisodeRecord {
    /// The file or shipped name of the policy or driver, as given by the user.
    pub policy: String,
    /// Number of the episode, from 1. Episodes with the same number, seed and scenario have the same start, goal and obstacles
    /// for every policy.
    pub episode: usize,
    /// `success`, `collision` or `timeout`.
    pub outcome: &'static str,
    /// What the robot collided with: `enclosure`, `wall`, `static obstacle` or `moving obstacle`. Of several, the one that was
    /// nearest when the episode ended.
    pub hit: Option<&'static str>,
    /// The index of that wall or obstacle in the scenario's list, from 0. Generated obstacles follow those of the file.
    pub hit_index: Option<usize>,
    /// The shape of that obstacle: `circle`, `rectangle`, `polygon` or `capsule`.
    pub hit_shape: Option<&'static str>,
    /// Length of the episode in control steps.
    pub steps: u32,
    /// Simulated time of the episode, in s.
    pub time_s: f64,
    /// Length of the path in m: the sum of the straight-line distances between the positions after consecutive control steps.
    pub path_length_m: Option<f64>,
    /// Length of the shortest path around static obstacles and walls to the edge of the goal, in m
    /// ([`shortest_paths_m`](super::shortest_paths_m)).
    pub shortest_path_m: f64,
    /// Success weighted by path length, 0 to 1: 0 after a failure, otherwise the shortest length divided by the larger of
    /// the actual length and the shortest (Anderson et al., *On evaluation of embodied navigation agents*, 2018).
    pub spl: Option<f64>,
    /// Smallest distance in m between the robot's body and a wall or an obstacle, at the start and after each control step.
    pub min_clearance_m: Option<f32>,
    /// The planner's time for the same episode, in s.
    pub optimal_time_s: Option<f64>,
    /// The proven lower bound on the time of the same episode, in s.
    pub lower_bound_time_s: Option<f64>,
    /// The robot's initial position along x, in m.
    pub start_x_m: f32,
    /// The robot's initial position along y, in m.
    pub start_y_m: f32,
    /// The robot's initial heading in rad, counterclockwise from the x axis.
    pub start_heading_rad: f32,
    /// The goal's position along x, in m.
    pub goal_x_m: f32,
    /// The goal's position along y, in m.
    pub goal_y_m: f32,
    /// The obstacles' clock at the start, in control steps.
    pub clock_steps: u64,
    /// The seed of the generated obstacles and of the numbers drawn from ranges, if the scenario has generators or ranges.
    pub layout_seed: Option<u64>,
}

impl EpisodeRecord {
    /// The record of `result`, which is episode `episode` (from 1) of an evaluation of `policy` in `scenario`.
    /// `shortest_path_m` is the length of the shortest path; `bounds` are those of the planner, if they are known.
    #[must_use]
    pub fn new(
        policy: &str,
        episode: usize,
        result: &EpisodeResult,
        scenario: &Scenario,
        shortest_path_m: f64,
        bounds: Option<StepBounds>,
    ) -> Self {
        let period_s = period_s(scenario.task.control_period_s);
        let time_s = |steps: u32| round_to_millionth(f64::from(steps) * period_s);
        // Without a plan, the bound is left out too: in a scenario that the planner does not support, it means nothing.
        let plan = bounds.and_then(|bounds| Some((bounds, bounds.plan_steps?)));
        let hit = result.path.and_then(|path| path.hit).map(|solid| Hit::new(solid, result, scenario));
        Self {
            policy: policy.into(),
            episode,
            outcome: outcome_name(result.end),
            hit: hit.map(|hit| hit.kind),
            hit_index: hit.and_then(|hit| hit.index),
            hit_shape: hit.and_then(|hit| hit.shape),
            steps: result.steps,
            time_s: time_s(result.steps),
            path_length_m: result.path.map(|path| round_to_millionth(path.length_m)),
            shortest_path_m: round_to_millionth(shortest_path_m),
            spl: result.spl(shortest_path_m).map(round_to_millionth),
            min_clearance_m: result.path.map(|path| path.min_clearance_m),
            optimal_time_s: plan.map(|(_, plan_steps)| time_s(plan_steps)),
            lower_bound_time_s: plan.map(|(bounds, _)| time_s(bounds.lower_steps)),
            start_x_m: result.start.x_m,
            start_y_m: result.start.y_m,
            start_heading_rad: result.start.heading_rad,
            goal_x_m: result.goal.x_m,
            goal_y_m: result.goal.y_m,
            clock_steps: result.clock.0,
            layout_seed: scenario.varies_by_episode().then_some(result.layout_seed),
        }
    }
}

/// What a robot has hit, as in the columns of the file.
#[derive(Clone, Copy)]
struct Hit {
    kind: &'static str,
    index: Option<usize>,
    shape: Option<&'static str>,
}

impl Hit {
    fn new(solid: Solid, result: &EpisodeResult, scenario: &Scenario) -> Self {
        match solid {
            Solid::Enclosure => Self { kind: "enclosure", index: None, shape: None },
            Solid::Wall(index) => Self { kind: "wall", index: Some(index), shape: None },
            Solid::Obstacle(index) => match scenario.obstacles.get(index) {
                Some(obstacle) => Self::obstacle(index, obstacle),
                None => {
                    let layout = scenario.with_generated_obstacles(result.layout_seed);
                    let obstacle = layout.obstacles.get(index);
                    obstacle.map_or(
                        Self { kind: "static obstacle", index: Some(index), shape: None },
                        |obstacle| Self::obstacle(index, obstacle),
                    )
                }
            },
        }
    }

    fn obstacle(index: usize, obstacle: &Obstacle) -> Self {
        let is_static = obstacle.motion == ObstacleMotion::Static;
        let shape = match obstacle.shape {
            Shape::Circle { .. } => "circle",
            Shape::Rectangle { .. } => "rectangle",
            Shape::Polygon { .. } => "polygon",
            Shape::Capsule { .. } => "capsule",
        };
        let kind = if is_static { "static obstacle" } else { "moving obstacle" };
        Self { kind, index: Some(index), shape: Some(shape) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::evaluate::PathMeasures;
    use crate::run::shipped;
    use crate::task::{Clock, EpisodeEnd, Goal, Pose};

    /// An episode of 50 steps along a path of 1.25 m that ended for the reason `end`.
    fn result(end: EpisodeEnd, hit: Option<Solid>) -> EpisodeResult {
        EpisodeResult {
            end,
            steps: 50,
            start: Pose { x_m: -0.5, y_m: 0.25, heading_rad: 1.0 },
            goal: Goal { x_m: 0.5, y_m: 0.25 },
            clock: Clock(7),
            layout_seed: 9,
            path: Some(PathMeasures { length_m: 1.25, min_clearance_m: 0.02, hit }),
        }
    }

    fn record(result: &EpisodeResult, scenario: &str) -> EpisodeRecord {
        let scenario = shipped::scenario(scenario).expect("shipped");
        EpisodeRecord::new("policy", 3, result, &scenario, 1.0, None)
    }

    #[test]
    fn spl_is_the_shortest_length_divided_by_the_actual_one_after_a_success_only() {
        let success = record(&result(EpisodeEnd::Reached, None), "scenario-1");
        assert_eq!((success.outcome, success.spl, success.time_s), ("success", Some(0.8), 10.0));
        let timeout = record(&result(EpisodeEnd::TimedOut, None), "scenario-1");
        assert_eq!((timeout.outcome, timeout.spl), ("timeout", Some(0.0)));
        let episode = result(EpisodeEnd::Reached, None);
        assert_eq!(episode.spl(2.0), Some(1.0), "a path cannot be better than the shortest");
        let still = PathMeasures { length_m: 0.0, min_clearance_m: 0.1, hit: None };
        assert_eq!(EpisodeResult { path: Some(still), ..episode }.spl(0.0), Some(1.0), "already there");
        let unmeasured = record(&EpisodeResult { path: None, ..episode }, "scenario-1");
        assert_eq!(
            (unmeasured.spl, unmeasured.path_length_m, unmeasured.min_clearance_m),
            (None, None, None)
        );
    }

    #[test]
    fn what_was_hit_is_named_by_its_kind_its_index_and_its_shape() {
        let first_generated = shipped::scenario("random-field").expect("shipped").obstacles.len();
        for (scenario, solid, expected) in [
            ("scenario-1", Solid::Enclosure, ("enclosure", None, None)),
            ("maze", Solid::Wall(2), ("wall", Some(2), None)),
            ("scenario-1", Solid::Obstacle(3), ("static obstacle", Some(3), Some("circle"))),
            ("scenario-2", Solid::Obstacle(0), ("moving obstacle", Some(0), Some("circle"))),
        ] {
            let record = record(&result(EpisodeEnd::Collided, Some(solid)), scenario);
            assert_eq!(
                (record.hit, record.hit_index, record.hit_shape),
                (Some(expected.0), expected.1, expected.2)
            );
            assert_eq!(record.layout_seed, None);
        }
        let record =
            record(&result(EpisodeEnd::Collided, Some(Solid::Obstacle(first_generated))), "random-field");
        assert_eq!((record.hit, record.layout_seed), (Some("static obstacle"), Some(9)));
        assert!(record.hit_shape.is_some(), "{record:?}");
    }
}
