//! The symbol of a motion: an arrow that bends in the direction of the turn and is longer for a higher speed, or a
//! square for a stop.

use egui::{Color32, Pos2, Rect, Shape, Stroke, Vec2, pos2};

use super::canvas::Canvas;
use super::transform::screen_direction;
use crate::scenario::Motion;

/// The side of the square that stands for a stop, in points.
const STOP: f32 = 7.0;

/// The highest absolute speed and turning rate of `motions`, both above 0.
pub fn fastest(motions: &[Motion]) -> Motion {
    let least = Motion { v_m_s: 1e-6, w_rad_s: 1e-6 };
    motions.iter().fold(least, |fastest, motion| Motion {
        v_m_s: fastest.v_m_s.max(motion.v_m_s.abs()),
        w_rad_s: fastest.w_rad_s.max(motion.w_rad_s.abs()),
    })
}

/// Draws the symbol of `motion` centred at `middle`; `fastest` is the [`fastest`] of the robot's motions.
pub fn draw(canvas: &Canvas, middle: Pos2, motion: Motion, fastest: Motion, color: Color32) {
    if motion.v_m_s == 0.0 && motion.w_rad_s == 0.0 {
        canvas.painter.rect_filled(Rect::from_center_size(middle, Vec2::splat(STOP)), 1.0, color);
        return;
    }
    let points = arc_points(motion, fastest);
    let (Some(&last), Some(&before)) = (points.last(), points.iter().rev().nth(1)) else { return };
    let shift = middle.to_vec2() - Rect::from_points(&points).center().to_vec2();
    let along = (last - before).normalized();
    let tip = last + shift + along * 2.0;
    let line = points.iter().map(|&point| point + shift).collect();
    canvas.painter.add(Shape::line(line, Stroke::new(1.5, color)));
    canvas.arrow_head(tip, along, 5.0, color);
}

/// The line of the arrow for a robot that faces up, in screen points with y down: an arc of up to 110°, or most of a circle
/// for a turn on the spot. At half of the highest speed it is three quarters as long.
fn arc_points(motion: Motion, fastest: Motion) -> Vec<Pos2> {
    const PARTS: usize = 10;
    let turn = (motion.w_rad_s / fastest.w_rad_s).clamp(-1.0, 1.0) * 1.92;
    let on_the_spot = motion.v_m_s.abs() < 1e-6;
    let (step, first) = if on_the_spot {
        (1.1, turn.signum() * -0.6)
    } else {
        (1.25 * (0.5 + 0.5 * motion.v_m_s.abs() / fastest.v_m_s), 0.0)
    };
    let step = if motion.v_m_s < 0.0 { -step } else { step };
    let turn = if on_the_spot { turn.signum() * 4.0 } else { turn };
    let mut at = pos2(0.0, 0.0);
    let mut points = vec![at];
    for k in 0..PARTS {
        let heading = first + turn * (k as f32 + 0.5) / PARTS as f32;
        at += screen_direction(std::f32::consts::FRAC_PI_2 + heading) * step;
        points.push(at);
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arrow_bends_in_the_direction_of_the_turn() {
        let fastest = fastest(&[Motion { v_m_s: 0.1, w_rad_s: -1.5 }, Motion { v_m_s: 0.15, w_rad_s: 0.0 }]);
        let end = |v_m_s, w_rad_s| {
            arc_points(Motion { v_m_s, w_rad_s }, fastest).last().copied().unwrap_or_default()
        };
        assert!(end(0.15, 1.5).x < -3.0 && end(0.15, -1.5).x > 3.0);
        assert!(end(0.15, 0.0).x.abs() < 1e-3 && end(0.15, 0.0).y < -8.0);
        let slow = end(0.075, 0.0).y / end(0.15, 0.0).y;
        assert!((slow - 0.75).abs() < 1e-5, "{slow}");
    }
}
