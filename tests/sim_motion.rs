//! The robot drives along the arcs of the commanded motions.

mod common;

use std::f64::consts::{PI, TAU};

use common::Lab;
use proptest::prelude::*;
use wayfield::scenario::Motion;
use wayfield::sim::{chord_velocity, integrate_heading};
use wayfield::task::Pose;

/// The pose after `t` seconds of constant (v, w), computed in f64.
fn arc((x, y, heading): (f64, f64, f64), motion: &Motion, t: f64) -> (f64, f64, f64) {
    let (v, w) = (f64::from(motion.v_m_s), f64::from(motion.w_rad_s));
    if w == 0.0 {
        return (x + v * t * heading.cos(), y + v * t * heading.sin(), heading);
    }
    let after = heading + w * t;
    (x + v / w * (after.sin() - heading.sin()), y - v / w * (after.cos() - heading.cos()), after)
}

fn to_f64(pose: &Pose) -> (f64, f64, f64) {
    (f64::from(pose.x_m), f64::from(pose.y_m), f64::from(pose.heading_rad))
}

/// The absolute difference of two headings, modulo full turns.
fn angle_between(a: f64, b: f64) -> f64 {
    let turn = (a - b).rem_euclid(TAU);
    turn.min(TAU - turn)
}

#[test]
fn each_of_the_five_motions_ends_on_its_arc_at_the_commanded_speed() {
    let scenario = common::wide_open();
    let mut lab = Lab::new(&scenario, 5, 1);
    for arena in 0..5 {
        lab.edit(arena, |state| state.pose = Pose { x_m: 0.3, y_m: -0.2, heading_rad: 0.5 });
    }
    let before = lab.states();
    lab.step(&[0, 1, 2, 3, 4]);
    let turning = [1.5, 0.75, 0.0, -0.75, -1.5];
    for (action, (before, after)) in before.iter().zip(lab.states()).enumerate() {
        let motion = Motion { v_m_s: 0.15, w_rad_s: turning[action] };
        let (x, y, heading) = arc(to_f64(&before.pose), &motion, 0.2);
        let end = to_f64(&after.pose);
        assert!(
            (end.0 - x).hypot(end.1 - y) < 1e-7 && angle_between(end.2, heading) < 1e-6,
            "motion {action}, (0.15 m/s, {} rad/s), must end at {:?} after 0.2 s, not at {end:?}",
            turning[action],
            (x, y, heading)
        );
        // The arc of 0.15 m/s x 0.2 s = 0.03 m is less than 0.4 % longer than its chord.
        let chord = (end.0 - 0.3_f32 as f64).hypot(end.1 + 0.2_f32 as f64);
        assert!((0.0298..0.030_001).contains(&chord), "a chord of {chord} m in 0.2 s is not 0.15 m/s");
    }
}

#[test]
fn a_thousand_random_motions_stay_on_the_closed_form_path() {
    let mut scenario = common::wide_open();
    // Long episodes, so that no reset interrupts the trajectory.
    scenario.task.max_episode_steps = 1_000_000;
    let arenas = 8;
    let mut lab = Lab::new(&scenario, arenas, 3);
    let mut action_streams = common::action_streams(arenas);
    for arena in 0..arenas {
        lab.edit(arena, |state| {
            (state.pose.x_m, state.pose.y_m) = (0.0, 0.0);
            state.goal.x_m = 90.0;
        });
    }
    let mut track: Vec<_> = lab.states().iter().map(|state| to_f64(&state.pose)).collect();
    let period = f64::from(scenario.task.control_period_s);
    for step in 1..=1000 {
        let before = lab.states();
        let actions = common::random_actions(&mut action_streams);
        lab.step(&actions);
        for (arena, after) in lab.states().iter().enumerate() {
            let motion = &scenario.robot.motions[actions[arena]];
            let end = to_f64(&after.pose);
            let expected = arc(to_f64(&before[arena].pose), motion, period);
            let off_m = (end.0 - expected.0).hypot(end.1 - expected.1);
            assert!(
                off_m < 3e-6 && angle_between(end.2, expected.2) < 1e-6,
                "step {step}: the arc ends at {expected:?}, the robot is at {end:?}"
            );
            assert!(
                end.2 > -PI - 1e-6 && end.2 <= PI + 1e-6,
                "step {step}: the heading {} is not wrapped",
                end.2
            );
            track[arena] = arc(track[arena], motion, period);
        }
    }
    for (arena, state) in lab.states().iter().enumerate() {
        let (end, expected) = (to_f64(&state.pose), track[arena]);
        let off_m = (end.0 - expected.0).hypot(end.1 - expected.1);
        let off_rad = angle_between(end.2, expected.2);
        assert!(
            off_m < 2e-4 && off_rad < 1e-4,
            "after 1000 steps the robot is {off_m} m and {off_rad} rad off the path computed in f64"
        );
        assert!(expected.0.hypot(expected.1) > 0.1, "the robot has moved");
    }
}

proptest! {
    #[test]
    fn one_step_with_the_chord_velocity_ends_at_the_end_of_the_arc(
        heading in -3.1_f32..3.1, v_m_s in -5.0_f32..5.0, w_rad_s in -20.0_f32..20.0, seconds in 0.001_f32..1.0,
    ) {
        let motion = Motion { v_m_s, w_rad_s };
        let (x, y, after) = arc((0.0, 0.0, f64::from(heading)), &motion, f64::from(seconds));
        let chord = chord_velocity(heading, &motion, seconds) * seconds;
        let off = (f64::from(chord.x) - x).hypot(f64::from(chord.y) - y);
        prop_assert!(off < 1e-5, "the chord ends {off} m off the arc");
        let heading_after = integrate_heading(heading, &motion, seconds);
        prop_assert!(angle_between(f64::from(heading_after), after) < 1e-5, "the heading changes by w t");
        prop_assert!(
            heading_after > -std::f32::consts::PI && heading_after <= std::f32::consts::PI,
            "the heading is wrapped"
        );
    }
}
