//! The card of Q-values next to the robot: a row for each motion, from the sharpest left turn to the sharpest right turn, with
//! its advantage (Q-value minus the mean) as a bar and its Q-value as a number. The chosen motion is highlighted. Of more
//! than [`MAX_ROWS`] motions, only the chosen one and the best one have a row.
//!
//! In: the Q-values of an [`ArenaScene`]. Out: a card near the robot that avoids covering it or the goal, and a line from the
//! robot to the card.

use std::cmp::Ordering;

use egui::{Align2, Id, Pos2, Rect, Stroke, pos2, vec2};

use super::canvas::Canvas;
use super::motion_arrow;
use super::q_card_position::card_rect;
use crate::app::scene::{ArenaScene, DriverLabel};
use crate::app::screen::numbers::{decimals_for, format_decimals};
use crate::scenario::{Motion, Scenario};

/// The maximum number of motions that all have a row; if there are more, only the chosen one and the best one have.
const MAX_ROWS: usize = 12;
const ROW: f32 = 16.0;
const HEAD: f32 = 18.0;
const FOOT: f32 = 15.0;
const PAD: f32 = 8.0;
/// Widths of the arrow, the bar and the number of a row, in points.
const ARROW: f32 = 22.0;
const BAR: f32 = 76.0;
const NUMBER: f32 = 48.0;

/// The indices of the motions, from the sharpest left turn to the sharpest right turn.
#[must_use]
pub fn motions_left_to_right(motions: &[Motion]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..motions.len()).collect();
    order.sort_by(|&a, &b| {
        let by_turn = motions[b].w_rad_s.partial_cmp(&motions[a].w_rad_s);
        let by_speed = motions[b].v_m_s.partial_cmp(&motions[a].v_m_s);
        by_turn.unwrap_or(Ordering::Equal).then(by_speed.unwrap_or(Ordering::Equal))
    });
    order
}

/// The indices of the motions shown, from left to right.
fn rows(motions: &[Motion], q: &[f32], chosen: usize) -> Vec<usize> {
    let mut order = motions_left_to_right(motions);
    order.retain(|&k| k < q.len());
    if order.len() > MAX_ROWS {
        let best = order.iter().copied().max_by(|&a, &b| q[a].total_cmp(&q[b]));
        order.retain(|&k| k == chosen || Some(k) == best);
    }
    order
}

/// Draws the card if all Q-values are finite, the robot is in view, and the view is large enough. The card avoids the
/// rectangles in `avoid`. Its position next to the robot is kept under `id`.
pub fn draw(canvas: &Canvas, scenario: &Scenario, arena: &ArenaScene, avoid: &[Rect], id: Id) {
    let (motions, q) = (&arena.motions, &arena.q_values);
    if q.is_empty() || !q.iter().all(|value| value.is_finite()) {
        return;
    }
    let rows = rows(motions, q, arena.action);
    // The learner explores, so its card has a last line that shows whether the action was random.
    let foot = if arena.driver == DriverLabel::Learner { FOOT } else { 0.0 };
    let size = vec2(ARROW + BAR + NUMBER + 2.0 * PAD, HEAD + rows.len() as f32 * ROW + foot + PAD);
    let view = canvas.transform.rect.shrink(8.0);
    let robot = canvas.to_screen([arena.pose.x_m, arena.pose.y_m]);
    if rows.is_empty() || 1.8 * size.x > view.width() || 1.8 * size.y > view.height() || !view.contains(robot)
    {
        return;
    }
    let body = canvas.transform.to_screen_length(scenario.robot.reach_m()).max(6.0);
    let card = card_rect(canvas, scenario, arena, size, body, avoid, id);
    leader(canvas, card, robot, body);
    canvas.card_background(card);
    draw_captions(canvas, card, arena, foot > 0.0);
    draw_rows(canvas, card.with_max_y(card.bottom() - foot), motions, arena, &rows);
}

/// Draws the column titles, and in the last line whether the action was random.
fn draw_captions(canvas: &Canvas, card: Rect, arena: &ArenaScene, has_last_line: bool) {
    let palette = &canvas.palette;
    let (top, right) = (card.top() + 4.0, card.right() - PAD);
    canvas.small_text(pos2(zero_x(card), top), Align2::CENTER_TOP, "advantage", palette.weak_text);
    canvas.small_text(pos2(right, top), Align2::RIGHT_TOP, "Q-value", palette.weak_text);
    if has_last_line {
        let (words, color) =
            if arena.explored { ("exploring", palette.warning) } else { ("greedy", palette.weak_text) };
        let at = pos2(card.left() + PAD, card.bottom() - 5.0);
        canvas.small_text(at, Align2::LEFT_BOTTOM, words, color);
    }
}

/// The x of an advantage of zero.
fn zero_x(card: Rect) -> f32 {
    card.left() + PAD + ARROW + BAR / 2.0
}

/// Draws a row for each motion in `rows`: arrow, bar and number.
fn draw_rows(canvas: &Canvas, card: Rect, motions: &[Motion], arena: &ArenaScene, rows: &[usize]) {
    let (palette, q, zero) = (&canvas.palette, &arena.q_values, zero_x(card));
    let highlight = if arena.explored { palette.warning } else { palette.accent };
    let mean = q.iter().sum::<f32>() / q.len() as f32;
    let max_advantage = q.iter().map(|value| (value - mean).abs()).fold(1e-6, f32::max);
    let decimals = decimals_for(q.iter().copied().fold(0.0, |max: f32, value| max.max(value.abs())));
    let fastest = motion_arrow::fastest(motions);
    let axis = card.top() + HEAD..=card.bottom() - PAD + 2.0;
    canvas.painter.vline(zero, axis, Stroke::new(1.0, palette.border));
    for (row, &k) in rows.iter().enumerate() {
        let y = card.top() + HEAD + (row as f32 + 0.5) * ROW;
        let chosen = k == arena.action;
        let color = if chosen { highlight } else { palette.weak_text };
        motion_arrow::draw(canvas, pos2(card.left() + PAD + 8.0, y), motions[k], fastest, color);
        let end = zero + (q[k] - mean) / max_advantage * (BAR / 2.0 - 4.0);
        let bar = Rect::from_x_y_ranges(zero.min(end)..=zero.max(end), y - 4.0..=y + 4.0);
        let fill = if chosen { highlight } else { palette.weak_text.gamma_multiply(0.55) };
        canvas.painter.rect_filled(bar, 1.5, fill);
        let (at, words) = (pos2(card.right() - PAD, y), format_decimals(q[k], decimals));
        canvas.small_text(at, Align2::RIGHT_CENTER, &words, if chosen { palette.text } else { color });
    }
}

/// Draws the line from the robot to the card.
fn leader(canvas: &Canvas, card: Rect, robot: Pos2, body: f32) {
    let near = card.clamp(robot);
    let away = near - robot;
    if away.length() > body + 4.0 {
        let start = robot + away.normalized() * (body + 3.0);
        canvas
            .painter
            .line_segment([start, near], Stroke::new(1.0, canvas.palette.weak_text.gamma_multiply(0.8)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn motion(v_m_s: f32, w_rad_s: f32) -> Motion {
        Motion { v_m_s, w_rad_s }
    }

    #[test]
    fn motions_are_ordered_from_left_to_right() {
        let motions =
            [motion(0.1, 0.0), motion(0.1, -1.5), motion(0.1, 1.5), motion(0.2, 0.0), motion(0.1, 0.7)];
        assert_eq!(motions_left_to_right(&motions), [2, 4, 3, 0, 1]);
    }

    #[test]
    fn of_many_motions_only_the_chosen_and_the_best_one_have_a_row() {
        let motions: Vec<Motion> = (0..13).map(|k| motion(0.1, k as f32)).collect();
        let mut q = vec![0.0; 13];
        q[3] = 5.0;
        assert_eq!(rows(&motions, &q, 7), [7, 3]);
        assert_eq!(rows(&motions[..12], &q[..12], 7).len(), 12);
        assert_eq!(rows(&motions[..5], &q[..2], 1), [1, 0], "no row without a value");
    }
}
