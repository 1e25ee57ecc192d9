//! The image of an episode: its path, and what the robot sensed at its end.

use bevy::prelude::*;

use super::{EpisodeResult, Evaluated, Evaluator};
use crate::run::{RunError, scenario_image};
use crate::task::{Arena, EpisodeSetup, Pose};

impl Evaluator {
    /// Runs only episode `index` (counted from 0) of [`Evaluator::run`]. Returns its result, and an image of its end as the text
    /// of an SVG file: obstacles, goal, the robot's path, and the robot with its last scan.
    ///
    /// # Errors
    /// As for [`Evaluator::run`], or drawing fails.
    pub fn episode_image<'a>(
        &mut self,
        evaluated: impl Into<Evaluated<'a>>,
        seed: u64,
        index: usize,
        setup: EpisodeSetup,
    ) -> Result<(EpisodeResult, String), RunError> {
        let mut run = self.start(evaluated, seed, 1, setup)?;
        run.first = index;
        let mut poses = self.world_mut().query::<(&Arena, &Pose)>();
        let mut path_m = Vec::new();
        self.begin(&mut run, 1);
        loop {
            let world = self.world_mut();
            let pose = poses.iter(world).find(|(arena, _)| arena.0 == 0).map(|(_, pose)| *pose);
            path_m.extend(pose.map(|pose| (f64::from(pose.x_m), f64::from(pose.y_m))));
            if let Some(episode) = run.episodes.first().copied() {
                let svg = scenario_image::frame_with_path(world, 0, path_m);
                let svg = svg.ok_or_else(|| RunError::Failed("the simulation has no arena".into()))?;
                let svg =
                    svg.map_err(|error| RunError::Failed(format!("an image can't be drawn: {error}")))?;
                return Ok((episode, svg));
            }
            // The time limit ends the episode.
            self.advance(&mut run)?;
        }
    }
}
