//! The ways that robots have driven: each arena's running navigation, and its last ones with their ends.
//!
//! In: poses and outcomes after each control step. Out: points in m. Bounded: so many navigations an arena.

use std::collections::VecDeque;

use bevy::prelude::*;

use crate::app::scene::{Trail, TrailEnd};
use crate::task::{Arena, Pose, StepOutcomes};

/// So many ended navigations are kept for each arena.
const MAX_TRAILS: usize = 24;

/// The ways of one arena.
#[derive(Clone, Debug, Default)]
pub struct ArenaTrails {
    /// The running navigation, oldest first, in m.
    pub path_m: Vec<[f32; 2]>,
    /// The last ones, oldest first.
    pub finished: VecDeque<Trail>,
    /// Targets reached since the driver began.
    pub goals_reached: u32,
    /// Collisions since then.
    pub collisions: u32,
    /// The pose before the last step, unless the robot has been put elsewhere since.
    pub previous_pose: Option<Pose>,
}

/// The ways of all arenas, by number.
#[derive(Resource, Default)]
pub struct Trails(pub Vec<ArenaTrails>);

impl Trails {
    /// Forgets everything: `arenas` arenas begin.
    pub fn restart(&mut self, arenas: usize) {
        self.0.clear();
        self.0.resize_with(arenas, ArenaTrails::default);
    }

    /// The robot of `arena` was put elsewhere: its way begins there.
    pub fn restart_path(&mut self, arena: usize) {
        if let Some(ways) = self.0.get_mut(arena) {
            ways.path_m.clear();
            ways.previous_pose = None;
        }
    }

    /// Notes where each robot is before a step.
    pub fn record_before_step(&mut self, arenas: &[(usize, Pose)]) {
        for (arena, pose) in arenas {
            if let Some(ways) = self.0.get_mut(*arena) {
                ways.previous_pose = Some(*pose);
                if ways.path_m.is_empty() {
                    ways.path_m.push([pose.x_m, pose.y_m]);
                }
            }
        }
    }

    /// Notes what came of the step.
    pub fn record_after_step(&mut self, arenas: &[(usize, Pose)], outcomes: &StepOutcomes) {
        for (arena, pose) in arenas {
            let (Some(ways), Some(outcome)) = (self.0.get_mut(*arena), outcomes.0.get(*arena)) else {
                continue;
            };
            if outcome.inactive {
                continue;
            }
            let end = if outcome.collided {
                ways.collisions += 1;
                Some(TrailEnd::Collided)
            } else if outcome.reached {
                ways.goals_reached += 1;
                Some(TrailEnd::Reached)
            } else if outcome.timed_out {
                Some(TrailEnd::TimedOut)
            } else {
                None
            };
            // After a collision or the time limit the robot stands at its next start already.
            let replaced = outcome.collided || outcome.timed_out;
            if !replaced {
                ways.path_m.push([pose.x_m, pose.y_m]);
            } else {
                ways.previous_pose = None;
            }
            if let Some(end) = end {
                let points_m = std::mem::take(&mut ways.path_m);
                if ways.finished.len() == MAX_TRAILS {
                    ways.finished.pop_front();
                }
                ways.finished.push_back(Trail { points_m, end });
            }
        }
    }
}

/// Where every robot is, by arena.
pub fn poses(world: &mut World) -> Vec<(usize, Pose)> {
    let mut arenas = world.query::<(&Arena, &Pose)>();
    arenas.iter(world).map(|(arena, pose)| (arena.0, *pose)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::task::StepOutcome;

    fn pose(x_m: f32) -> Pose {
        Pose { x_m, ..Pose::default() }
    }

    fn drive(trails: &mut Trails, from: f32, to: f32, outcome: StepOutcome) {
        trails.record_before_step(&[(0, pose(from))]);
        trails.record_after_step(&[(0, pose(to))], &StepOutcomes(vec![outcome]));
    }

    #[test]
    fn a_navigation_ends_where_its_target_is_and_the_next_begins_there() {
        let mut trails = Trails::default();
        trails.restart(1);
        drive(&mut trails, 0.0, 0.1, StepOutcome::default());
        drive(&mut trails, 0.1, 0.2, StepOutcome { reached: true, ..StepOutcome::default() });
        drive(&mut trails, 0.2, 0.3, StepOutcome::default());
        let ways = &trails.0[0];
        assert_eq!(ways.finished[0].points_m, [[0.0, 0.0], [0.1, 0.0], [0.2, 0.0]]);
        assert_eq!((ways.finished[0].end, ways.goals_reached), (TrailEnd::Reached, 1));
        assert_eq!(ways.path_m, [[0.2, 0.0], [0.3, 0.0]]);
    }

    #[test]
    fn after_a_collision_nothing_is_drawn_to_the_next_start() {
        let mut trails = Trails::default();
        trails.restart(1);
        drive(&mut trails, 0.0, 1.7, StepOutcome { collided: true, ..StepOutcome::default() });
        assert_eq!(trails.0[0].finished[0].points_m, [[0.0, 0.0]]);
        assert!(trails.0[0].path_m.is_empty() && trails.0[0].previous_pose.is_none());
        assert_eq!(trails.0[0].collisions, 1);
    }

    #[test]
    fn so_many_are_kept_and_no_more() {
        let mut trails = Trails::default();
        trails.restart(1);
        for k in 0..100 {
            let x = k as f32;
            drive(&mut trails, x, x, StepOutcome { reached: true, ..StepOutcome::default() });
        }
        assert_eq!(trails.0[0].finished.len(), MAX_TRAILS);
        assert_eq!(trails.0[0].finished[MAX_TRAILS - 1].points_m[0], [99.0, 0.0], "the latest is there");
    }
}
