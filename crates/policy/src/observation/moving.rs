//! The paths of discs that move, as the robot expects them, and the frames of earlier scans.
//!
//! Lengths are in units of the robot, which `sectors.rs` defines; times are in control steps.

use super::tracker::Disc;

/// The number of chords that replace the arc of a disc that turns. The last one goes on for ever.
const CHORDS: u8 = 6;
/// The number of control steps that a chord stands for.
const STEPS_PER_CHORD: f32 = 5.0;

/// A margin that is larger than the rounding errors of a distance.
pub(super) const MARGIN: f32 = 0.01;

/// A motion with a constant speed and a constant turning rate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Motion {
    /// The present velocity: displacement in a control step.
    pub(super) velocity: (f32, f32),
    /// The turn in a control step, counterclockwise positive, in rad.
    pub(super) turn: f32,
}

impl Motion {
    /// The displacement from now to the moment `steps` control steps later, or earlier if `steps` is negative.
    pub(super) fn displacement(self, steps: f32) -> (f32, f32) {
        let (x, y) = self.velocity;
        // The chord of the arc forms this angle with the present velocity.
        let angle = 0.5 * self.turn * steps;
        let (sin, cos) = libm::sincosf(angle);
        let steps = if angle.abs() > 1e-3 { steps * sin / angle } else { steps };
        (steps * (x * cos - y * sin), steps * (x * sin + y * cos))
    }
}

/// A straight part of the path of a disc, in the robot's present frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Leg {
    /// The disc where it is now.
    pub(super) disc: Disc,
    /// When the leg begins: the number of control steps from now.
    from: f32,
    /// How many control steps it takes.
    steps: f32,
    /// Where the disc is when the leg begins.
    start: (f32, f32),
    /// Displacement in a control step.
    velocity: (f32, f32),
}

impl Leg {
    /// The path of `disc`: one leg, or the chords of an arc.
    pub(super) fn path(disc: Disc, motion: Motion) -> impl Iterator<Item = Self> {
        let legs = if motion.turn == 0.0 { 1 } else { CHORDS };
        let at = move |steps: f32| {
            let (dx, dy) = motion.displacement(steps);
            (disc.x + dx, disc.y + dy)
        };
        let mut end = (disc.x, disc.y);
        (1..=legs).map(move |leg| {
            let from = STEPS_PER_CHORD * f32::from(leg - 1);
            let start = end;
            let mut velocity = motion.velocity;
            if legs > 1 {
                end = at(from + STEPS_PER_CHORD);
                velocity = ((end.0 - start.0) / STEPS_PER_CHORD, (end.1 - start.1) / STEPS_PER_CHORD);
            }
            let steps = if leg < legs { STEPS_PER_CHORD } else { f32::INFINITY };
            Self { disc, from, steps, start, velocity }
        })
    }

    /// Whether the edge of the disc may come within `distance` of the origin on this leg, in the next `steps`. A margin makes up for
    /// rounding errors.
    pub(super) fn comes_within(&self, distance: f32, steps: f32) -> bool {
        let Self { disc, from, start, velocity, .. } = self;
        let moved = length(*velocity) * self.steps.min(steps - from);
        *from <= steps && length(*start) - moved < distance + disc.radius + MARGIN
    }

    /// Where the disc is after `steps`, if that is on this leg.
    pub(super) fn position(&self, steps: f32) -> Option<(f32, f32)> {
        let Self { start, velocity, from, .. } = self;
        let steps = steps - from;
        let position = (start.0 + velocity.0 * steps, start.1 + velocity.1 * steps);
        (0.0..self.steps).contains(&steps).then_some(position)
    }

    /// The number of control steps until the robot, moving from the origin by `step` in each of them, collides with the
    /// disc; infinite if they do not collide on this leg. It has no branches, so that the compiler can vectorize a loop over
    /// many values of `step`.
    #[inline(always)]
    pub(super) fn steps_to_collision(&self, step: (f32, f32)) -> f32 {
        let Self { disc, from, start, velocity, .. } = self;
        let relative = (step.0 - velocity.0, step.1 - velocity.1);
        let (x, y) = (start.0 - from * step.0, start.1 - from * step.1);
        let speed_2 = relative.0 * relative.0 + relative.1 * relative.1;
        let along = x * relative.0 + y * relative.1;
        let reach = 1.0 + disc.radius;
        let apart_2 = x * x + y * y - reach * reach;
        let root_2 = along * along - speed_2 * apart_2;
        let steps = if apart_2 <= 0.0 { 0.0 } else { (along - root_2.sqrt()) / speed_2 };
        let collide = (along > 0.0) & (speed_2 > 1e-9) & (root_2 > 0.0) & (steps < self.steps);
        if collide { from + steps } else { f32::INFINITY }
    }

    /// Whether a robot that begins at the origin and drives straight in some direction, by `step` in each control step, may
    /// collide with the disc on this leg. If not, [`steps_to_collision`](Self::steps_to_collision) is infinite in all directions.
    pub(super) fn is_in_reach(&self, step: f32) -> bool {
        let Self { disc, from, start, velocity, .. } = self;
        let (distance, speed) = (length(*start), length(*velocity));
        // The rounding errors of a collision grow with the square of the distance.
        let driven = (from + STEPS_PER_CHORD) * step;
        let reach = 1.0 + disc.radius + MARGIN + 1e-6 * driven * driven;
        if self.steps.is_infinite() {
            // If the robot is farther out when the leg begins, a disc that is not faster never catches up.
            return distance + reach > from * step || speed + MARGIN > step;
        }
        let moved = speed * self.steps;
        distance + moved + reach > from * step && distance - moved - reach < (from + self.steps) * step
    }
}

fn length((x, y): (f32, f32)) -> f32 {
    (x * x + y * y).sqrt()
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

    /// The number of control steps until a collision with a disc on any leg of its path.
    fn steps_to_collision(disc: Disc, motion: Motion, step: (f32, f32)) -> f32 {
        Leg::path(disc, motion).map(|leg| leg.steps_to_collision(step)).fold(f32::INFINITY, f32::min)
    }

    #[test]
    fn steps_to_a_collision_match_a_calculation_by_hand() {
        let disc = |x, y| Disc { x, y, radius: 0.5 };
        // A disc 6 units ahead comes nearer by 0.5 a step; contact is at 1 + 0.5 units.
        let comes = Motion { velocity: (-0.5, 0.0), turn: 0.0 };
        let steps = |step| steps_to_collision(disc(6.0, 0.0), comes, step);
        assert_eq!(steps((0.0, 0.0)), 4.5 / 0.5);
        assert_eq!(steps((1.0, 0.0)), 4.5 / 1.5);
        assert_eq!(steps((-0.5, 0.0)), f32::INFINITY, "it never catches up");
        assert_eq!(steps((0.0, 1.0)), f32::INFINITY, "the robot is out of its way");
        assert_eq!(steps_to_collision(disc(1.4, 0.0), comes, (0.0, 0.0)), 0.0);
    }

    #[test]
    fn a_motion_with_a_turn_is_an_arc() {
        // A quarter of a circle to the left in 10 steps, with a radius of 2 / (pi / 20).
        let turn = std::f32::consts::PI / 20.0;
        let motion = Motion { velocity: (0.0, 2.0), turn };
        let radius = 2.0 / turn;
        let (x, y) = motion.displacement(10.0);
        assert!((x + radius).abs() < 1e-4 && (y - radius).abs() < 1e-4, "{x}, {y}");
        let (x, y) = motion.displacement(-10.0);
        assert!((x + radius).abs() < 1e-4 && (y + radius).abs() < 1e-4, "{x}, {y}");
        assert_eq!(Motion { turn: 0.0, ..motion }.displacement(3.0), (0.0, 6.0));
    }

    /// A number from -0.5 to 0.5 that differs from case to case; one sequence for each factor.
    fn number(case: u16, factor: f32) -> f32 {
        (f32::from(case) * factor).fract() - 0.5
    }

    /// A disc in a square with this side around the origin, and its motion.
    fn drawn(case: u16, side: f32) -> (Disc, Motion) {
        let disc = Disc { x: side * number(case, 0.618), y: side * number(case, 0.414), radius: 0.7 };
        let velocity = (number(case, 0.732), number(case, 0.236));
        (disc, Motion { velocity, turn: 0.16 * number(case, 0.854) })
    }

    #[test]
    fn no_robot_collides_on_a_leg_out_of_reach() {
        let mut out_of_reach = [0; 2];
        for case in 0..1000_u16 {
            let (disc, motion) = drawn(case, 30.0);
            for leg in Leg::path(disc, motion) {
                for step in [0.3_f32, 3.0, 50.0] {
                    if leg.is_in_reach(step) {
                        continue;
                    }
                    out_of_reach[0] += 1;
                    for direction in 0..36_u8 {
                        let (sin, cos) = (f32::from(direction) * 0.1745).sin_cos();
                        assert_eq!(
                            leg.steps_to_collision((step * cos, step * sin)),
                            f32::INFINITY,
                            "{leg:?}"
                        );
                    }
                }
                if !leg.comes_within(4.0, 10.0) {
                    out_of_reach[1] += 1;
                    let positions = (0..=100_u8).filter_map(|tenths| leg.position(0.1 * f32::from(tenths)));
                    let mut distances = positions.map(|(x, y)| x.hypot(y) - disc.radius);
                    assert!(distances.all(|distance| distance > 4.0), "{leg:?}");
                }
            }
        }
        assert!(
            out_of_reach.iter().all(|count| *count > 1000),
            "of some 18,000 and 6,000 legs: {out_of_reach:?}"
        );
    }

    #[test]
    fn collisions_with_discs_that_turn_are_those_of_a_simulation_in_small_steps() {
        let mut collisions = [0; 2];
        for case in 0..1000_u16 {
            let (disc, motion) = drawn(case, 12.0);
            let step = (0.8 * number(case, 0.123), 0.8 * number(case, 0.567));
            if length((disc.x, disc.y)) < 2.0 {
                continue;
            }
            let gap = |steps: f32| {
                let (dx, dy) = motion.displacement(steps);
                (disc.x + dx - steps * step.0).hypot(disc.y + dy - steps * step.1) - 1.7
            };
            let times = || (0..600_u16).map(|part| 0.05 * f32::from(part));
            let expected = times().find(|&time| gap(time) < 0.0);
            let found = steps_to_collision(disc, motion, step);
            // A chord is at most 0.18 units away from its arc.
            let nearest = times().map(gap).fold(f32::INFINITY, f32::min);
            match expected {
                Some(time) if nearest < -0.3 => {
                    assert!(gap(found).abs() < 0.2 && (found - time).abs() < 1.5, "{case}: {found}, {time}");
                    collisions[0] += 1;
                }
                None if nearest > 0.2 => {
                    assert!(found >= 30.0, "{case}: {found}");
                    collisions[1] += 1;
                }
                _ => {}
            }
        }
        assert!(collisions.iter().all(|&cases| cases > 100), "{collisions:?}");
    }
}
