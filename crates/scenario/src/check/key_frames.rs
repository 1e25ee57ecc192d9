//! The checks of key frames: their number, their times, the speeds between them, and whether the motion stops at the last.

use std::fmt::Arguments;

use super::speeds::{SLACK, fastest_m_s, too_fast};
use super::{Diagnostics, Note, NoteLevel, SECONDS, rounded_up};
use crate::limits::*;
use crate::schema::*;

/// Checks the count, times and positions of the key frames of the motion at `path`, if it has any.
pub(super) fn check(path: Arguments<'_>, motion: &ObstacleMotion, diagnostics: &mut Diagnostics) {
    let ObstacleMotion::KeyFrames { frames, end } = motion else { return };
    diagnostics.check_count(format_args!("{path}.frames"), frames.len(), 1..=MAX_KEY_FRAMES);
    let mut before_s = 0.0;
    for (k, frame) in frames.iter().enumerate().take(MAX_KEY_FRAMES) {
        let path = format_args!("{path}.frames[{k}]");
        check_time(format_args!("{path}.time_s"), frame.time_s, before_s, diagnostics);
        diagnostics.check_point(format_args!("{path}.position_m"), frame.position_m);
        before_s = frame.time_s;
    }
    if let KeyFrameEnd::Loop { period_s } = *end {
        check_time(format_args!("{path}.end.period_s"), period_s, before_s, diagnostics);
    }
}

fn check_time(path: Arguments<'_>, time_s: f32, before_s: f32, diagnostics: &mut Diagnostics) {
    diagnostics.check_range(path, time_s, KEY_FRAME_TIME_S, SECONDS);
    if KEY_FRAME_TIME_S.contains(&time_s) && time_s <= before_s {
        let message = format!("is {time_s}: write more than the time of the previous frame, {before_s} s");
        diagnostics.push(path, message);
    }
}

/// Checks the total number of key frames of `obstacles`.
pub(super) fn check_total(obstacles: &[Obstacle], diagnostics: &mut Diagnostics) {
    let count = |obstacle: &Obstacle| match &obstacle.motion {
        ObstacleMotion::KeyFrames { frames, .. } => frames.len(),
        _ => 0,
    };
    let counts = obstacles.iter().map(count);
    let total: usize = counts.clone().sum();
    if total > MAX_KEY_FRAMES && counts.max().is_some_and(|most| most <= MAX_KEY_FRAMES) {
        let message = format!("have {total} key frames in total: write at most {MAX_KEY_FRAMES}");
        diagnostics.push(format_args!("obstacles"), message);
    }
}

/// Checks the speeds between the key frames of obstacle `k`. `period_s` is the control period.
pub(super) fn check_speeds(k: usize, obstacle: &Obstacle, period_s: f32, diagnostics: &mut Diagnostics) {
    let ObstacleMotion::KeyFrames { frames, .. } = &obstacle.motion else { return };
    for (index, leg) in obstacle.legs().enumerate().take(MAX_KEY_FRAMES + 1) {
        let Some(speed_m_s) = leg.speed_m_s().map(|speed| speed as f32) else { continue };
        let fix = || {
            format!(
                "make the leg of {:.3} m last at least {} s",
                leg.length_m,
                rounded_up(leg.length_m / f64::from(fastest_m_s(period_s)), 3)
            )
        };
        let problem = if speed_m_s > MAX_SPEED_M_S * SLACK {
            format!("{}: {}", too_fast(speed_m_s), fix())
        } else if speed_m_s * period_s > MAX_STEP_M * SLACK {
            format!(
                "moves the obstacle {:.3} m in one control step, above the limit of {MAX_STEP_M} m: {}",
                speed_m_s * period_s,
                fix()
            )
        } else {
            continue;
        };
        let path = format_args!("obstacles[{k}].motion");
        match index < frames.len() {
            true => diagnostics.push(format_args!("{path}.frames[{index}].time_s"), problem),
            false => diagnostics.push(format_args!("{path}.end.period_s"), problem),
        }
    }
}

/// Adds a note about each motion that stops at its last key frame.
pub(super) fn note_stops(scenario: &Scenario, notes: &mut Vec<Note>) {
    for (k, obstacle) in scenario.obstacles.iter().enumerate() {
        if let ObstacleMotion::KeyFrames { frames, end: KeyFrameEnd::Stop } = &obstacle.motion
            && let Some(last) = frames.last()
        {
            let message = format!(
                "stops after {} s, but the obstacles' clock runs on between episodes, and evaluations begin at random times: \
                 write end: Loop(period_s: ...), unless that is intended",
                last.time_s
            );
            notes.push(Note::new(NoteLevel::Note, format!("obstacles[{k}].motion"), message));
        }
    }
}
