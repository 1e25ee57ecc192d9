//! Edits to the path of a motion: to its waypoints, or to its key frames with their times.

use super::key_frames;
use super::limits::{KEY_FRAME_TIME_S, WAYPOINTS};
use super::schema::{KeyFrame, KeyFrameEnd, Obstacle, ObstacleMotion};
use glam::Vec2;

impl ObstacleMotion {
    /// The position of waypoint or key frame `k`, in m. `None` if it does not exist.
    #[must_use]
    pub fn waypoint_mut(&mut self, k: usize) -> Option<&mut Vec2> {
        match self {
            Self::Patrol { waypoints_m, .. }
            | Self::BackAndForth { waypoints_m, .. }
            | Self::Pedestrian { goals_m: waypoints_m, .. } => waypoints_m.get_mut(k),
            Self::KeyFrames { frames, .. } => frames.get_mut(k).map(|frame| &mut frame.position_m),
            _ => None,
        }
    }

    /// Inserts a point before waypoint `k`, or a key frame halfway in time between its neighbours. `None` if that is not
    /// possible.
    pub fn insert_waypoint(&mut self, k: usize, position_m: Vec2) -> Option<()> {
        match self {
            Self::Patrol { waypoints_m, .. }
            | Self::BackAndForth { waypoints_m, .. }
            | Self::Pedestrian { goals_m: waypoints_m, .. } => {
                (k <= waypoints_m.len()).then(|| waypoints_m.insert(k, position_m))
            }
            Self::KeyFrames { frames, end } => {
                let before_s = k.checked_sub(1).map_or(Some(0.0), |last| Some(frames.get(last)?.time_s))?;
                let after_s = match (frames.get(k), *end) {
                    (Some(frame), _) => frame.time_s,
                    (None, KeyFrameEnd::Loop { period_s }) => period_s,
                    (None, KeyFrameEnd::Stop) => return None,
                };
                frames.insert(k, KeyFrame { time_s: before_s.midpoint(after_s), position_m });
                Some(())
            }
            _ => None,
        }
    }

    /// Removes waypoint or key frame `k`. `None` if it does not exist or is the only one.
    pub fn remove_waypoint(&mut self, k: usize) -> Option<()> {
        let removable = |count: usize| k < count && count > *WAYPOINTS.start();
        match self {
            Self::Patrol { waypoints_m, .. }
            | Self::BackAndForth { waypoints_m, .. }
            | Self::Pedestrian { goals_m: waypoints_m, .. } => {
                removable(waypoints_m.len()).then(|| waypoints_m.remove(k))?;
            }
            Self::KeyFrames { frames, .. } => {
                removable(frames.len()).then(|| frames.remove(k))?;
            }
            _ => return None,
        }
        Some(())
    }

    /// Key frames along a path from `start_m`, in m, at `speed_m_s` above 0, repeated if `is_loop`. Times are rounded up to
    /// hundredths of a second, so that no leg is faster, and capped at the largest valid time.
    #[must_use]
    pub fn key_frames_along(start_m: Vec2, path_m: &[Vec2], speed_m_s: f32, is_loop: bool) -> Self {
        let (mut at_m, mut hundredths) = (start_m, 0.0);
        let mut time_at = |to_m: Vec2| {
            hundredths += (100.0 * at_m.distance(to_m) / speed_m_s).ceil().max(1.0);
            at_m = to_m;
            (hundredths / 100.0).min(*KEY_FRAME_TIME_S.end())
        };
        let frames = path_m.iter().map(|&position_m| KeyFrame { time_s: time_at(position_m), position_m });
        let frames = frames.collect();
        let end = if is_loop { KeyFrameEnd::Loop { period_s: time_at(start_m) } } else { KeyFrameEnd::Stop };
        Self::KeyFrames { frames, end }
    }
}

impl Obstacle {
    /// Replaces the path of the motion by one through `path_m`, in m. A motion without a path becomes a patrol at `speed_m_s`.
    /// Key frames get the speed `speed_m_s`, too; other motions keep their speed.
    pub fn set_path(&mut self, path_m: Vec<Vec2>, speed_m_s: f32) {
        match &mut self.motion {
            ObstacleMotion::Patrol { waypoints_m, .. }
            | ObstacleMotion::BackAndForth { waypoints_m, .. }
            | ObstacleMotion::Pedestrian { goals_m: waypoints_m, .. } => *waypoints_m = path_m,
            ObstacleMotion::KeyFrames { end, .. } => {
                let is_loop = *end != KeyFrameEnd::Stop;
                self.motion = ObstacleMotion::key_frames_along(self.position_m, &path_m, speed_m_s, is_loop);
            }
            _ => self.motion = ObstacleMotion::Patrol { waypoints_m: path_m, speed_m_s: speed_m_s.into() },
        }
    }

    /// The mean speed along the path, in m/s: its length divided by its duration. `None` for motions without a path, or with
    /// a duration or speed of 0.
    #[must_use]
    pub fn mean_speed_m_s(&self) -> Option<f32> {
        let speed_m_s = match self.motion {
            ObstacleMotion::Patrol { speed_m_s, .. }
            | ObstacleMotion::BackAndForth { speed_m_s, .. }
            | ObstacleMotion::Pedestrian { speed_m_s, .. } => speed_m_s.value(),
            ObstacleMotion::KeyFrames { .. } => {
                let whole = self.legs().reduce(key_frames::Leg::then)?;
                whole.speed_m_s()? as f32
            }
            _ => return None,
        };
        (speed_m_s > 0.0).then_some(speed_m_s)
    }
}
