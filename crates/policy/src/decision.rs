//! The choice of an action by its Q-value, such that a robot does not drive into what it sees coming, and does not stay in one
//! place for ever.
//!
//! The greedy action may lead to a collision that the robot could foresee from the motion of what it sees. So an action is passed
//! over if the robot would collide within [`FORESIGHT_STEPS`](crate::observation::FORESIGHT_STEPS) whatever it did after that
//! action, while another action avoids that. What it may do after an action: keep to one of its motions or, if its motions allow
//! it, turn on the spot to one of 16 headings and drive straight ahead.
//!
//! Where nothing moves, a greedy robot that stands still can stay for ever: small errors of the Q-values are enough to make
//! waiting the best action, or turning left at one heading and right at the next. So a robot with
//! [relative actions](crate::ActionSet::Relative)
//!
//! - turns on the spot to one side only, until it drives again;
//! - keeps waiting only if something moves.

use std::f32::consts::TAU;

use crate::observation::FollowUp;
use crate::{MotionLimits, greedy};

/// The number of headings, evenly spaced, in which a robot may leave.
const HEADINGS: u8 = 16;

/// The memory of one robot's decisions. Use a new one in each episode, and call [`sense`](Self::sense) before each
/// [`choose`](Self::choose).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Decider {
    /// The direction in which the robot has turned on the spot since it last drove: positive to the left, negative to the right,
    /// 0 if it has not.
    turned: f32,
    /// Whether the robot neither drives nor turns.
    is_still: bool,
}

impl Decider {
    /// Takes in the robot's actual speed in m/s and turning rate in rad/s. Each counts as 0 up to a tenth of the
    /// largest magnitude that `limits` allows.
    pub fn sense(&mut self, (v_m_s, w_rad_s): (f32, f32), limits: &MotionLimits) {
        let is_still = |value: f32, (low, high): (f32, f32)| value.abs() <= 0.1 * high.max(-low);
        let turns = !is_still(w_rad_s, limits.w_rad_s);
        if !is_still(v_m_s, limits.v_m_s) {
            *self = Self::default();
            return;
        }
        self.is_still = !turns;
        if turns {
            self.turned = w_rad_s;
        }
    }

    /// The action with the largest Q-value in `q_row` among those after which the robot can avoid a collision longest, and
    /// that do not hold it in its place; if every action holds it, the [`greedy`] one.
    ///
    /// `motion` gives the speed in m/s and the turning rate in rad/s that an action means for the robot; `moves` says whether the
    /// robot sees something that moves; `steps_to_collision` gives the number of control steps until a collision, infinite
    /// for none, if the robot has a motion for one step and then does something
    /// ([`SectorObserver::steps_to_collision`](crate::observation::SectorObserver::steps_to_collision)).
    #[must_use]
    pub fn choose(
        &self,
        q_row: &[f32],
        motion: impl Fn(usize) -> (f32, f32),
        moves: bool,
        steps_to_collision: impl Fn((f32, f32), FollowUp) -> f32,
    ) -> usize {
        let holds = |action: usize| {
            let (v_m_s, w_rad_s) = motion(action);
            let undoes = w_rad_s * self.turned < 0.0;
            let waits_on = w_rad_s == 0.0 && self.is_still && !moves;
            v_m_s == 0.0 && (undoes || waits_on)
        };
        let allowed = || (0..q_row.len()).filter(|&action| !holds(action));
        let best = allowed().reduce(|best, action| if q_row[action] > q_row[best] { action } else { best });
        let Some(best) = best else { return greedy(q_row) };
        let escapes = || escapes((0..q_row.len()).map(&motion));
        let steps = |action: usize| {
            let first = motion(action);
            let others = (0..q_row.len()).filter(|&then| then != action).map(&motion);
            let mut longest = steps_to_collision(first, FollowUp::Keep(first));
            for then in others.map(FollowUp::Keep).chain(escapes()) {
                if longest.is_infinite() {
                    break;
                }
                longest = longest.max(steps_to_collision(first, then));
            }
            longest
        };
        let mut chosen = (best, steps(best));
        // Most often the best action is safe; then no other one is checked.
        if chosen.1.is_finite() {
            for action in allowed().filter(|&action| action != best) {
                let steps = steps(action);
                if steps > chosen.1 || (steps == chosen.1 && q_row[action] > q_row[chosen.0]) {
                    chosen = (action, steps);
                }
            }
        }
        chosen.0
    }
}

/// The ways to leave in any direction for a robot with these motions (speeds in m/s, turning rates in rad/s): none unless it can
/// turn on the spot to both sides and drive straight ahead.
fn escapes(motions: impl Iterator<Item = (f32, f32)>) -> impl Iterator<Item = FollowUp> {
    let (mut left, mut right, mut ahead_m_s) = (0.0_f32, 0.0_f32, 0.0_f32);
    for (v_m_s, w_rad_s) in motions {
        if v_m_s == 0.0 {
            (left, right) = (left.max(w_rad_s), right.min(w_rad_s));
        } else if w_rad_s == 0.0 {
            ahead_m_s = ahead_m_s.max(v_m_s);
        }
    }
    let is_possible = left > 0.0 && right < 0.0 && ahead_m_s > 0.0;
    (0..if is_possible { HEADINGS } else { 0 }).map(move |index| {
        let heading_rad = TAU * f32::from(index) / f32::from(HEADINGS);
        FollowUp::TurnTo { heading_rad, turns_rad_s: (left, right), ahead_m_s }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: MotionLimits = MotionLimits { v_m_s: (0.0, 0.5), w_rad_s: (-1.0, 1.0) };
    const STILL: (f32, f32) = (0.0, 0.0);
    const LEFT: (f32, f32) = (0.0, 1.0);
    const AHEAD: (f32, f32) = (0.5, 0.0);

    /// A bend to the right, then on the spot: a turn to the left, waiting, a turn to the right.
    const MOTIONS: [(f32, f32); 4] = [(0.5, -1.0), (0.0, 1.0), (0.0, 0.0), (0.0, -1.0)];

    /// No action leads to a collision.
    fn never(_: (f32, f32), _: FollowUp) -> f32 {
        f32::INFINITY
    }

    /// The action that is chosen for the Q-values `q_row` after the robot has had the motions `moved`.
    fn chosen(moved: &[(f32, f32)], q_row: [f32; 4], moves: bool) -> usize {
        let mut decider = Decider::default();
        for motion in moved {
            decider.sense(*motion, &LIMITS);
        }
        decider.choose(&q_row, |action| MOTIONS[action], moves, never)
    }

    #[test]
    fn a_turn_on_the_spot_is_not_undone_until_the_robot_drives() {
        let right_is_best = [1.0, 0.0, 2.0, 3.0];
        assert_eq!(chosen(&[STILL], right_is_best, true), 3);
        assert_eq!(chosen(&[LEFT], right_is_best, true), 2, "the second-best action");
        assert_eq!(chosen(&[LEFT, STILL], right_is_best, true), 2, "also after a pause");
        assert_eq!(chosen(&[LEFT, AHEAD, STILL], right_is_best, true), 3);
        assert_eq!(chosen(&[LEFT], [4.0, 0.0, 2.0, 3.0], true), 0, "a bend is not a turn on the spot");
    }

    #[test]
    fn a_robot_goes_on_waiting_only_if_something_moves() {
        let waiting_is_best = [1.0, 2.0, 3.0, 0.0];
        assert_eq!(chosen(&[AHEAD], waiting_is_best, false), 2, "it may stop");
        assert_eq!(chosen(&[AHEAD, STILL], waiting_is_best, false), 1);
        assert_eq!(chosen(&[AHEAD, STILL], waiting_is_best, true), 2);
    }

    #[test]
    fn a_robot_that_cannot_turn_on_the_spot_does_not_wait_by_trying_to_turn() {
        let mut decider = Decider::default();
        decider.sense(STILL, &LIMITS);
        let motions = [(0.5, -1.0), (0.0, 0.0), (0.0, 0.0), (0.0, 0.0)];
        assert_eq!(decider.choose(&[1.0, 2.0, 3.0, 0.0], |action| motions[action], false, never), 0);
    }

    #[test]
    fn if_every_action_holds_the_robot_the_greedy_one_is_chosen() {
        let decider = Decider { turned: 0.0, is_still: true };
        assert_eq!(decider.choose(&[0.0, 1.0], |_| (0.0, 0.0), false, never), 1);
    }

    #[test]
    fn an_action_after_which_a_collision_is_inevitable_is_passed_over() {
        const FIVE: [(f32, f32); 5] = [MOTIONS[0], MOTIONS[1], MOTIONS[2], MOTIONS[3], AHEAD];
        fn choice(steps: impl Fn((f32, f32), FollowUp) -> f32) -> usize {
            Decider::default().choose(&[3.0, 2.0, 1.0, 0.0, -1.0], |action| FIVE[action], true, steps)
        }
        assert_eq!(choice(|first, _| if first == MOTIONS[0] { 2.0 } else { f32::INFINITY }), 1);
        let unless = |avoids: FollowUp| {
            move |first, then| if first == MOTIONS[0] && then != avoids { 2.0 } else { f32::INFINITY }
        };
        let turn_right = unless(FollowUp::Keep(MOTIONS[3]));
        assert_eq!(choice(turn_right), 0, "a turn to the right in the next step avoids it");
        let leave = escapes(FIVE.into_iter()).nth(5).expect("it can turn and drive");
        assert_eq!(choice(unless(leave)), 0, "it can leave in one direction");
        let later = |first, _| if first == MOTIONS[2] { 5.0 } else { 2.0 };
        assert_eq!(choice(later), 2, "none avoids it: the one with the latest collision");
        assert_eq!(choice(|_, _| 2.0), 0, "nothing helps: the best Q-value");
    }

    #[test]
    fn a_robot_leaves_in_any_direction_only_with_its_own_motions() {
        let motions = [(0.5, 0.5), (0.3, 0.0), (-0.5, 0.0), (0.0, 1.0), (0.0, -0.2), (0.0, 0.5)];
        let found: Vec<FollowUp> = escapes(motions.into_iter()).collect();
        assert_eq!(found.len(), usize::from(HEADINGS));
        let east_north_east = TAU / f32::from(HEADINGS);
        let expected =
            FollowUp::TurnTo { heading_rad: east_north_east, turns_rad_s: (1.0, -0.2), ahead_m_s: 0.3 };
        assert_eq!(found[1], expected);
        for unable in [&motions[..4], &motions[2..], &[(0.5, 0.5), (0.5, -0.5)]] {
            assert_eq!(escapes(unable.iter().copied()).count(), 0, "{unable:?}");
        }
    }
}
