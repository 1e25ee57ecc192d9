//! The titles of figures, and the spacing of labels that would overlap.

use plotters::style::text_anchor::HPos;

use super::canvas::{Canvas, DrawResult, TITLE, write};
use super::palette::INK;
use super::text::wrapped;

/// The y positions of labels, moved at least `gap` apart within `low..=high`, or closer if the range is too small. The
/// order of the labels is kept; element `i` belongs to label `i`.
pub(crate) fn spread(positions: &[i32], gap: i32, (low, high): (i32, i32)) -> Vec<i32> {
    let count = positions.len() as i32;
    let gap = if count > 1 { gap.min((high - low) / (count - 1)) } else { gap };
    let mut order: Vec<usize> = (0..positions.len()).collect();
    order.sort_by_key(|&i| (positions[i], i));
    // The first pass moves labels down from `low`; the second moves them up from `high`.
    let mut moved = positions.to_vec();
    let mut minimum = low;
    for &i in &order {
        moved[i] = moved[i].max(minimum);
        minimum = moved[i] + gap;
    }
    let mut maximum = high;
    for &i in order.iter().rev() {
        moved[i] = moved[i].min(maximum);
        maximum = moved[i] - gap;
    }
    moved
}

/// Writes a figure's title, wrapped to `width`; its height is [`title_height`].
pub(crate) fn draw_title(root: &Canvas, title: &str, (left, width): (i32, i32)) -> DrawResult {
    for (line, text) in (0..).zip(wrapped(title, TITLE, width)) {
        write(root, &text, (left, 52 + line * 50), TITLE, &INK, HPos::Left)?;
    }
    Ok(())
}

/// The height of a title wrapped to `width`, in drawn pixels.
pub(crate) fn title_height(title: &str, width: i32) -> i32 {
    40 + 50 * wrapped(title, TITLE, width).len() as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_moved_apart_and_stay_in_range() {
        assert_eq!(spread(&[50, 10, 52], 20, (0, 100)), [50, 10, 70]);
        assert_eq!(spread(&[95, 98], 20, (0, 100)), [80, 100]);
        assert_eq!(spread(&[0, 0, 0], 80, (0, 100)), [0, 50, 100]);
        assert_eq!(spread(&[300], 20, (0, 100)), [100]);
        assert!(spread(&[], 20, (0, 100)).is_empty());
    }
}
