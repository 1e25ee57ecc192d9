//! Steering with the arrow keys in Drive mode. The keys choose among the robot's motions, so that a person
//! and a policy have the same actions.
//!
//! In: the arrow keys held down. Out: [`Command::Steer`] when the motion changes.

use egui::{Key, Ui};

use crate::app::commands::{Command, SessionMode};
use crate::app::screen::input::ScreenInput;
use crate::scenario::Motion;

/// In Drive mode, sends the motion selected by the arrow keys whenever it changes; `last` is the scenario and the index of
/// the motion that was sent last. While a question is open (`asked`) or a text is being edited, no key counts as held.
pub fn handle(
    ui: &Ui,
    view: &ScreenInput<'_>,
    asked: bool,
    last: &mut Option<(String, usize)>,
    commands: &mut Vec<Command>,
) {
    if view.status.mode != SessionMode::Drive {
        *last = None;
        return;
    }
    let ignored = asked || ui.ctx().text_edit_focused();
    let held = |key| !ignored && ui.input(|i| i.key_down(key));
    let (left, right) = (held(Key::ArrowLeft), held(Key::ArrowRight));
    // The user drives in the first arena. Another scenario, even one of the same set, may have other motions, so the motion
    // is then sent again.
    let Some(arena) = view.scene.arenas.first() else { return };
    let Some(motion) = steered(&arena.scenario.robot.motions, left, right, held(Key::ArrowUp)) else {
        return;
    };
    let scenario = arena.set_member.as_ref().unwrap_or(&view.status.scenario_from);
    let now = Some((scenario.clone(), motion));
    if *last != now {
        commands.push(Command::Steer(motion));
        *last = now;
    }
}

/// The index of the motion for the arrow keys held down. With left or right alone, it is the sharpest turn to that side, or the
/// gentlest if up is held too. Otherwise, or without a turn to that side, it is the straightest motion. Of motions that turn
/// equally, it is the fastest. `None` without motions.
fn steered(motions: &[Motion], left: bool, right: bool, up: bool) -> Option<usize> {
    let turn = |&(_, motion): &(usize, &Motion)| motion.w_rad_s.abs();
    let gentler = |a: &(usize, &Motion), b: &(usize, &Motion)| {
        turn(a).total_cmp(&turn(b)).then(b.1.v_m_s.total_cmp(&a.1.v_m_s))
    };
    let sharper = |a: &(usize, &Motion), b: &(usize, &Motion)| {
        turn(b).total_cmp(&turn(a)).then(b.1.v_m_s.total_cmp(&a.1.v_m_s))
    };
    let indexed = || motions.iter().enumerate();
    let straight = indexed().min_by(gentler);
    let turns = |to_left: bool| {
        indexed().filter(move |(_, m)| if to_left { m.w_rad_s > 0.0 } else { m.w_rad_s < 0.0 })
    };
    let chosen = match (left, right) {
        (true, false) if up => turns(true).min_by(gentler),
        (true, false) => turns(true).min_by(sharper),
        (false, true) if up => turns(false).min_by(gentler),
        (false, true) => turns(false).min_by(sharper),
        _ => straight,
    };
    chosen.or(straight).map(|(index, _)| index)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::Robot;

    #[test]
    fn the_arrow_keys_reach_all_five_motions() {
        let motions = Robot::default().motions;
        let chosen = |left, right, up| steered(&motions, left, right, up);
        assert_eq!(chosen(false, false, false), Some(2));
        assert_eq!(chosen(false, false, true), Some(2));
        assert_eq!(chosen(true, false, false), Some(0));
        assert_eq!(chosen(true, false, true), Some(1));
        assert_eq!(chosen(false, true, true), Some(3));
        assert_eq!(chosen(false, true, false), Some(4));
        assert_eq!(chosen(true, true, false), Some(2), "both cancel out");
    }

    #[test]
    fn a_robot_that_can_stop_and_turn_on_the_spot_is_driven_by_its_fastest_motions() {
        let motion = |v_m_s, w_rad_s| Motion { v_m_s, w_rad_s };
        let motions =
            [motion(0.0, 0.0), motion(0.0, 1.0), motion(0.4, 1.0), motion(0.4, 0.0), motion(0.2, -1.0)];
        assert_eq!(steered(&motions, false, false, false), Some(3), "not the stop");
        assert_eq!(steered(&motions, true, false, false), Some(2), "not the turn on the spot");
        assert_eq!(steered(&motions, false, true, true), Some(4));
    }

    #[test]
    fn a_missing_turn_falls_back_to_the_straightest_motion() {
        let ahead = Motion { v_m_s: 0.2, w_rad_s: 0.0 };
        assert_eq!(steered(&[ahead], true, false, false), Some(0));
        assert_eq!(steered(&[], true, false, false), None);
    }
}
