//! Discs that move, as the robot sees them at one moment, and the frames of earlier scans.
//!
//! Lengths are in units of the robot, which `sectors.rs` defines.

use super::tracker::Disc;

/// A disc that moves, in the robot's present frame, with its displacement in a control step, in units of the robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MovingDisc {
    pub(super) disc: Disc,
    pub(super) velocity: (f32, f32),
}

impl MovingDisc {
    /// The number of control steps until the robot, moving from the origin by `step` in each of them, collides with the
    /// disc; infinite if they do not collide. Without branches, so that a loop over many steps is vectorized.
    #[inline(always)]
    pub(super) fn steps_to_collision(&self, step: (f32, f32)) -> f32 {
        let Self { disc, velocity } = self;
        let relative = (step.0 - velocity.0, step.1 - velocity.1);
        let speed_2 = relative.0 * relative.0 + relative.1 * relative.1;
        let along = disc.x * relative.0 + disc.y * relative.1;
        let reach = 1.0 + disc.radius;
        let apart_2 = disc.x * disc.x + disc.y * disc.y - reach * reach;
        let root_2 = along * along - speed_2 * apart_2;
        let steps = if apart_2 <= 0.0 { 0.0 } else { (along - root_2.sqrt()) / speed_2 };
        let collide = (along > 0.0) & (speed_2 > 1e-9) & (root_2 > 0.0);
        if collide { steps } else { f32::INFINITY }
    }

    /// Whether a hit belongs to the disc: whether it is inside, or at most `margin` outside.
    pub(super) fn contains(&self, (x, y): (f32, f32), margin: f32) -> bool {
        let (dx, dy) = (x - self.disc.x, y - self.disc.y);
        let reach = self.disc.radius + margin;
        dx * dx + dy * dy < reach * reach
    }
}

/// The frame of the robot at a pose, in another frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    cos: f32,
    sin: f32,
    origin: (f32, f32),
}

impl Frame {
    /// The robot's frame at the pose `then`, relative to its frame at the pose `now`, in units of `unit_m`. Poses are x
    /// in m, y in m and heading in rad.
    pub(super) fn between(then: (f32, f32, f32), now: (f32, f32, f32), unit_m: f32) -> Self {
        let (sin, cos) = libm::sincosf(now.2);
        let (dx, dy) = (then.0 - now.0, then.1 - now.1);
        let origin = ((dx * cos + dy * sin) / unit_m, (dy * cos - dx * sin) / unit_m);
        let (sin, cos) = libm::sincosf(then.2 - now.2);
        Self { cos, sin, origin }
    }

    /// Converts a point of this frame to the present frame.
    pub(super) fn to_present(self, (x, y): (f32, f32)) -> (f32, f32) {
        let Self { cos, sin, origin } = self;
        (x * cos - y * sin + origin.0, x * sin + y * cos + origin.1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_an_earlier_frame_are_converted_to_the_present_one() {
        // The robot has moved ahead by 0.3 and turned left by a right angle: it sees ahead what was to its left.
        let frame = Frame { cos: 0.0, sin: -1.0, origin: (0.0, 0.3) };
        let point = frame.to_present((0.3, 2.0));
        assert!((point.0 - 2.0).abs() < 1e-6 && point.1.abs() < 1e-6, "{point:?}");
    }

    #[test]
    fn steps_to_a_collision_match_a_calculation_by_hand() {
        let disc = |x, y| Disc { x, y, radius: 0.5 };
        // A disc 6 units ahead comes nearer by 0.5 a step; contact is at 1 + 0.5 units.
        let moving = MovingDisc { disc: disc(6.0, 0.0), velocity: (-0.5, 0.0) };
        assert_eq!(moving.steps_to_collision((0.0, 0.0)), 4.5 / 0.5);
        assert_eq!(moving.steps_to_collision((1.0, 0.0)), 4.5 / 1.5);
        assert_eq!(moving.steps_to_collision((-0.5, 0.0)), f32::INFINITY, "it never catches up");
        assert_eq!(moving.steps_to_collision((0.0, 1.0)), f32::INFINITY, "the robot is out of its way");
        let touching = MovingDisc { disc: disc(1.4, 0.0), velocity: (-0.5, 0.0) };
        assert_eq!(touching.steps_to_collision((0.0, 0.0)), 0.0);
    }
}
