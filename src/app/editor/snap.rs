//! Snapping of positions, sizes and angles. Without snapping they are rounded to 1 mm and 0.0001 rad.

use bevy::math::{Vec2, vec2};

use super::limits::MIN_SIZE_M;
use super::points::{to_angle, to_mm};

/// The settings of the grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Snap {
    /// Whether to snap.
    pub on: bool,
    /// The grid step in m, one of [`Snap::STEPS_M`].
    pub step_m: f32,
}

impl Default for Snap {
    fn default() -> Self {
        Self { on: true, step_m: 0.05 }
    }
}

impl Snap {
    /// The grid steps to choose from, in m.
    pub const STEPS_M: [f32; 4] = [0.05, 0.1, 0.25, 0.5];
    /// The step of angles, in degrees.
    pub const STEP_DEGREES: f32 = 15.0;

    /// The same settings, without snapping if `free`.
    pub(super) fn disabled_if(self, free: bool) -> Self {
        Self { on: self.on && !free, ..self }
    }

    /// A position: each coordinate snaps to the grid through (0, 0) or to the scenario's `centre`, whichever is nearer.
    pub(super) fn point(self, position: Vec2, centre: Vec2) -> Vec2 {
        vec2(self.coordinate(position.x, centre.x), self.coordinate(position.y, centre.y))
    }

    fn coordinate(self, at: f32, centre: f32) -> f32 {
        if !self.on {
            return to_mm(at);
        }
        let grid = self.stepped(at);
        to_mm(if (centre - at).abs() < (grid - at).abs() { centre } else { grid })
    }

    /// A size: a multiple of the step, at least one step. Without snapping, at least 1 cm.
    pub(super) fn size(self, size_m: f32) -> f32 {
        if self.on { self.stepped(size_m).max(self.step_m) } else { to_mm(size_m).max(MIN_SIZE_M) }
    }

    /// An angle in rad: a multiple of 15°.
    pub(super) fn angle(self, angle_rad: f32) -> f32 {
        let step = Self::STEP_DEGREES.to_radians();
        to_angle(if self.on { (angle_rad / step).round() * step } else { angle_rad })
    }

    fn stepped(self, at: f32) -> f32 {
        to_mm((at / self.step_m).round() * self.step_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_snap_to_the_grid_or_to_the_centre() {
        let snap = Snap { on: true, step_m: 0.25 };
        assert_eq!(snap.point(vec2(0.37, -0.38), vec2(0.0, 0.0)), vec2(0.25, -0.5));
        assert_eq!(snap.point(vec2(0.37, -0.38), vec2(0.4, -0.4)), vec2(0.4, -0.4), "the centre is nearer");
        assert_eq!(snap.point(vec2(0.13, 0.1), vec2(0.1, 5.0)), vec2(0.1, 0.0), "each axis snaps on its own");
        assert_eq!(snap.disabled_if(true).point(vec2(0.371_4, -0.38), vec2(0.0, 0.0)), vec2(0.371, -0.38));
    }

    #[test]
    fn sizes_are_at_least_one_step() {
        let snap = Snap { on: true, step_m: 0.1 };
        assert_eq!([0.34, 0.02, -3.0].map(|size| snap.size(size)), [0.3, 0.1, 0.1]);
        let free = snap.disabled_if(true);
        assert_eq!([0.344_4, 0.001, -3.0].map(|size| free.size(size)), [0.344, 0.01, 0.01]);
    }

    #[test]
    fn angles_snap_to_fifteen_degrees() {
        let snap = Snap::default();
        let degrees = |angle: f32| snap.angle(angle.to_radians()).to_degrees().round();
        assert_eq!([37.0, 38.0, -7.0, 200.0].map(degrees), [30.0, 45.0, 0.0, -165.0]);
        assert_eq!(snap.disabled_if(true).angle(0.123_456), 0.1235);
    }
}
