//! Trails: each arena's path towards its current goal, and its last finished paths with their outcomes.
//!
//! In: poses before and after each control step, and its outcomes. Out: points in m. Memory is bounded by `MAX_TRAILS` paths per
//! arena. A path ends at every goal, collision or timeout.

use std::collections::VecDeque;

use bevy::prelude::*;

use crate::app::scene::{Score, Trail, TrailEnd};
use crate::task::{Arena, ArenaLayout, Pose, StepOutcomes};

/// Number of finished paths kept for each arena.
const MAX_TRAILS: usize = 24;

/// The paths of one arena.
#[derive(Clone, Debug, Default)]
pub struct ArenaTrails {
    /// Path towards the current goal, oldest point first, in m.
    pub path_m: Vec<[f32; 2]>,
    /// Finished paths, oldest first.
    pub finished: VecDeque<Trail>,
    /// Outcomes since the current driver took over.
    pub score: Score,
    /// Pose before the last step; `None` if the robot has been moved since, or has a new start.
    pub previous_pose: Option<Pose>,
    /// The control period of the last step, in s. Scenarios of a set may have different ones.
    period_s: f32,
}

/// The paths of all arenas, by arena index.
#[derive(Resource, Default)]
pub struct Trails(pub Vec<ArenaTrails>);

impl Trails {
    /// Clears everything, for `arenas` arenas.
    pub fn restart(&mut self, arenas: usize) {
        self.0.clear();
        self.0.resize_with(arenas, ArenaTrails::default);
    }

    /// Restarts the path of `arena`, whose robot has been moved.
    pub fn restart_path(&mut self, arena: usize) {
        if let Some(paths) = self.0.get_mut(arena) {
            paths.path_m.clear();
            paths.previous_pose = None;
        }
    }

    /// Records where each robot is before a step, and its control period, in s.
    pub fn record_before_step(&mut self, arenas: &[(usize, Pose, f32)]) {
        for (arena, pose, period_s) in arenas {
            if let Some(paths) = self.0.get_mut(*arena) {
                paths.previous_pose = Some(*pose);
                paths.period_s = *period_s;
                if paths.path_m.is_empty() {
                    paths.path_m.push([pose.x_m, pose.y_m]);
                }
            }
        }
    }

    /// Records where each robot is after a step, and how the step ended.
    pub fn record_after_step(&mut self, arenas: &[(usize, Pose, f32)], outcomes: &StepOutcomes) {
        for (arena, pose, _) in arenas {
            let (Some(paths), Some(outcome)) = (self.0.get_mut(*arena), outcomes.0.get(*arena)) else {
                continue;
            };
            if outcome.inactive {
                continue;
            }
            let end = if outcome.collided {
                paths.score.collided += 1;
                Some(TrailEnd::Collided)
            } else if outcome.reached {
                paths.score.reached += 1;
                // The path has a point for the start and for each step but this one.
                paths.score.reached_time_s += paths.path_m.len() as f64 * f64::from(paths.period_s);
                Some(TrailEnd::Reached)
            } else if outcome.timed_out {
                paths.score.timed_out += 1;
                Some(TrailEnd::TimedOut)
            } else {
                None
            };
            // After a collision or a timeout the robot may already be at its next start.
            let replaced = outcome.collided || outcome.timed_out;
            if !replaced {
                paths.path_m.push([pose.x_m, pose.y_m]);
            } else {
                paths.previous_pose = None;
            }
            if let Some(end) = end {
                let points_m = std::mem::take(&mut paths.path_m);
                if paths.finished.len() == MAX_TRAILS {
                    paths.finished.pop_front();
                }
                paths.finished.push_back(Trail { points_m, end });
            }
        }
    }
}

/// For each robot: the index of its arena, its pose, and the control period of its scenario in s.
pub fn poses(world: &mut World) -> Vec<(usize, Pose, f32)> {
    let mut arenas = world.query::<(&Arena, &Pose, &ArenaLayout)>();
    let entry = |(arena, pose, layout): (&Arena, &Pose, &ArenaLayout)| {
        (arena.0, *pose, layout.written.task.control_period_s)
    };
    arenas.iter(world).map(entry).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::task::StepOutcome;

    fn pose(x_m: f32) -> Pose {
        Pose { x_m, ..Pose::default() }
    }

    fn drive(trails: &mut Trails, from: f32, to: f32, outcome: StepOutcome) {
        drive_for(trails, 0.25, from, to, outcome);
    }

    fn drive_for(trails: &mut Trails, period_s: f32, from: f32, to: f32, outcome: StepOutcome) {
        trails.record_before_step(&[(0, pose(from), period_s)]);
        // The next episode may be in another scenario.
        trails.record_after_step(&[(0, pose(to), 9.0)], &StepOutcomes(vec![outcome]));
    }

    #[test]
    fn a_path_ends_at_the_goal_and_the_next_one_starts_there() {
        let mut trails = Trails::default();
        trails.restart(1);
        drive(&mut trails, 0.0, 0.1, StepOutcome::default());
        drive(&mut trails, 0.1, 0.2, StepOutcome { reached: true, ..StepOutcome::default() });
        drive(&mut trails, 0.2, 0.3, StepOutcome::default());
        let paths = &trails.0[0];
        assert_eq!(paths.finished[0].points_m, [[0.0, 0.0], [0.1, 0.0], [0.2, 0.0]]);
        let score = Score { reached: 1, reached_time_s: 0.5, ..Score::default() };
        assert_eq!((paths.finished[0].end, paths.score), (TrailEnd::Reached, score));
        assert_eq!(paths.path_m, [[0.2, 0.0], [0.3, 0.0]]);
        drive(&mut trails, 0.3, 0.4, StepOutcome { timed_out: true, ..StepOutcome::default() });
        let score = trails.0[0].score;
        assert_eq!((score.attempts(), score.success_rate(), score.mean_time_s()), (2, Some(0.5), Some(0.5)));
        drive_for(&mut trails, 0.5, 0.0, 0.1, StepOutcome { reached: true, ..StepOutcome::default() });
        assert_eq!(trails.0[0].score.mean_time_s(), Some(0.5), "0.5 s in two steps, and 0.5 s in one");
    }

    #[test]
    fn no_line_leads_from_a_collision_to_the_next_start() {
        let mut trails = Trails::default();
        trails.restart(1);
        drive(&mut trails, 0.0, 1.7, StepOutcome { collided: true, ..StepOutcome::default() });
        assert_eq!(trails.0[0].finished[0].points_m, [[0.0, 0.0]]);
        assert!(trails.0[0].path_m.is_empty() && trails.0[0].previous_pose.is_none());
        assert_eq!(trails.0[0].score.collided, 1);
    }

    #[test]
    fn only_the_latest_paths_are_kept() {
        let mut trails = Trails::default();
        trails.restart(1);
        for k in 0..100 {
            let x = k as f32;
            drive(&mut trails, x, x, StepOutcome { reached: true, ..StepOutcome::default() });
        }
        assert_eq!(trails.0[0].finished.len(), MAX_TRAILS);
        assert_eq!(trails.0[0].finished[MAX_TRAILS - 1].points_m[0], [99.0, 0.0], "the latest path is kept");
    }
}
