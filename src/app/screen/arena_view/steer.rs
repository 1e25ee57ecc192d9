//! Steering by hand: the arrow keys as the robot's own motions, so that a person and a policy have the same choice.
//!
//! In: which arrows are held. Out: [`Command::Steer`], whenever it is another motion than before.

use egui::{Key, Ui};

use crate::app::commands::{Command, SessionMode};
use crate::app::screen::input::ScreenInput;
use crate::scenario::Motion;

/// In Drive mode, sends the motion that the arrow keys ask for whenever it changes; `last` is the motion sent last.
pub fn handle(
    ui: &Ui,
    view: &ScreenInput<'_>,
    last: &mut Option<(String, usize)>,
    commands: &mut Vec<Command>,
) {
    if view.status.mode != SessionMode::Drive {
        *last = None;
        return;
    }
    let typing = ui.ctx().text_edit_focused();
    let held = |key| !typing && ui.input(|i| i.key_down(key));
    let (left, right) = (held(Key::ArrowLeft), held(Key::ArrowRight));
    let Some(motion) = steered(&view.scene.scenario.robot.motions, left, right, held(Key::ArrowUp)) else {
        return;
    };
    // Another scenario may have other motions, so the motion is sent again there.
    let now = Some((view.status.scenario_from.clone(), motion));
    if *last != now {
        commands.push(Command::Steer(motion));
        *last = now;
    }
}

/// Which of `motions` the arrows ask for: without left or right the straightest, with one of them the sharpest turn to
/// that side, and the gentlest if up is held with it.
fn steered(motions: &[Motion], left: bool, right: bool, up: bool) -> Option<usize> {
    let turn = |&(_, motion): &(usize, &Motion)| motion.w_rad_s.abs();
    let by_turn = |a: &(usize, &Motion), b: &(usize, &Motion)| turn(a).total_cmp(&turn(b));
    let all = || motions.iter().enumerate();
    let straight = all().min_by(by_turn);
    let aside =
        |to_left: bool| all().filter(move |(_, m)| if to_left { m.w_rad_s > 0.0 } else { m.w_rad_s < 0.0 });
    let chosen = match (left, right) {
        (true, false) if up => aside(true).min_by(by_turn),
        (true, false) => aside(true).max_by(by_turn),
        (false, true) if up => aside(false).min_by(by_turn),
        (false, true) => aside(false).max_by(by_turn),
        _ => straight,
    };
    chosen.or(straight).map(|(index, _)| index)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::Robot;

    #[test]
    fn arrows_ask_for_the_five_motions() {
        let motions = Robot::default().motions;
        let asked = |left, right, up| steered(&motions, left, right, up);
        assert_eq!(asked(false, false, false), Some(2));
        assert_eq!(asked(false, false, true), Some(2));
        assert_eq!(asked(true, false, false), Some(0));
        assert_eq!(asked(true, false, true), Some(1));
        assert_eq!(asked(false, true, true), Some(3));
        assert_eq!(asked(false, true, false), Some(4));
        assert_eq!(asked(true, true, false), Some(2), "both cancel out");
    }

    #[test]
    fn a_robot_with_other_motions_does_what_it_can() {
        let ahead = Motion { v_m_s: 0.2, w_rad_s: 0.0 };
        assert_eq!(steered(&[ahead], true, false, false), Some(0));
        assert_eq!(steered(&[], true, false, false), None);
    }
}
