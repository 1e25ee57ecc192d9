//! The ways that robots have driven: each arena's running navigation, and its last ones with their ends.
//!
//! In: poses and outcomes after each control step. Out: points in m. Bounded: so many navigations an arena.

use std::collections::VecDeque;

use bevy::prelude::*;

use crate::app::scene::{Trail, TrailEnd};
use crate::task::{Arena, Outcomes, Pose};

/// So many ended navigations are kept for each arena.
const KEPT: usize = 24;

/// The ways of one arena.
#[derive(Clone, Debug, Default)]
pub struct Ways {
    /// The running navigation, oldest first, in m.
    pub path_m: Vec<[f32; 2]>,
    /// The last ones, oldest first.
    pub ended: VecDeque<Trail>,
    /// Targets reached since the driver began.
    pub targets: u32,
    /// Collisions since then.
    pub collisions: u32,
    /// The pose before the last step, unless the robot has been put elsewhere since.
    pub before: Option<Pose>,
}

/// The ways of all arenas, by number.
#[derive(Resource, Default)]
pub struct Trails(pub Vec<Ways>);

impl Trails {
    /// Forgets everything: `arenas` arenas begin.
    pub fn restart(&mut self, arenas: usize) {
        self.0.clear();
        self.0.resize_with(arenas, Ways::default);
    }

    /// The robot of `arena` was put elsewhere: its way begins there.
    pub fn lift(&mut self, arena: usize) {
        if let Some(ways) = self.0.get_mut(arena) {
            ways.path_m.clear();
            ways.before = None;
        }
    }

    /// Notes where each robot is before a step.
    pub fn before(&mut self, arenas: &[(usize, Pose)]) {
        for (arena, pose) in arenas {
            if let Some(ways) = self.0.get_mut(*arena) {
                ways.before = Some(*pose);
                if ways.path_m.is_empty() {
                    ways.path_m.push([pose.x_m, pose.y_m]);
                }
            }
        }
    }

    /// Notes what came of the step.
    pub fn after(&mut self, arenas: &[(usize, Pose)], outcomes: &Outcomes) {
        for (arena, pose) in arenas {
            let (Some(ways), Some(outcome)) = (self.0.get_mut(*arena), outcomes.0.get(*arena)) else {
                continue;
            };
            if outcome.parked {
                continue;
            }
            let end = if outcome.collided {
                ways.collisions += 1;
                Some(TrailEnd::Collided)
            } else if outcome.reached {
                ways.targets += 1;
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
                ways.before = None;
            }
            if let Some(end) = end {
                let points_m = std::mem::take(&mut ways.path_m);
                if ways.ended.len() == KEPT {
                    ways.ended.pop_front();
                }
                ways.ended.push_back(Trail { points_m, end });
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
    use crate::task::Outcome;

    fn pose(x_m: f32) -> Pose {
        Pose { x_m, ..Pose::default() }
    }

    fn drive(trails: &mut Trails, from: f32, to: f32, outcome: Outcome) {
        trails.before(&[(0, pose(from))]);
        trails.after(&[(0, pose(to))], &Outcomes(vec![outcome]));
    }

    #[test]
    fn a_navigation_ends_where_its_target_is_and_the_next_begins_there() {
        let mut trails = Trails::default();
        trails.restart(1);
        drive(&mut trails, 0.0, 0.1, Outcome::default());
        drive(&mut trails, 0.1, 0.2, Outcome { reached: true, ..Outcome::default() });
        drive(&mut trails, 0.2, 0.3, Outcome::default());
        let ways = &trails.0[0];
        assert_eq!(ways.ended[0].points_m, [[0.0, 0.0], [0.1, 0.0], [0.2, 0.0]]);
        assert_eq!((ways.ended[0].end, ways.targets), (TrailEnd::Reached, 1));
        assert_eq!(ways.path_m, [[0.2, 0.0], [0.3, 0.0]]);
    }

    #[test]
    fn after_a_collision_nothing_is_drawn_to_the_next_start() {
        let mut trails = Trails::default();
        trails.restart(1);
        drive(&mut trails, 0.0, 1.7, Outcome { collided: true, ..Outcome::default() });
        assert_eq!(trails.0[0].ended[0].points_m, [[0.0, 0.0]]);
        assert!(trails.0[0].path_m.is_empty() && trails.0[0].before.is_none());
        assert_eq!(trails.0[0].collisions, 1);
    }

    #[test]
    fn so_many_are_kept_and_no_more() {
        let mut trails = Trails::default();
        trails.restart(1);
        for k in 0..100 {
            let x = k as f32;
            drive(&mut trails, x, x, Outcome { reached: true, ..Outcome::default() });
        }
        assert_eq!(trails.0[0].ended.len(), KEPT);
        assert_eq!(trails.0[0].ended[KEPT - 1].points_m[0], [99.0, 0.0], "the latest is there");
    }
}
