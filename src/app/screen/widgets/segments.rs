//! A segmented control: a few choices in a row, of which at most one is selected.
//!
//! In: the choices and the selected one. Out: the one that was clicked.

use egui::{FontId, Id, Rect, Sense, Stroke, StrokeKind, Ui, UiBuilder, WidgetInfo, WidgetType, vec2};

use crate::app::screen::theme::{BODY, Palette};

/// One choice of a segmented control.
#[derive(Clone, Debug, PartialEq)]
pub struct Segment {
    /// The text on it.
    pub text: String,
    /// The accessible name.
    pub name: String,
    /// The tooltip.
    pub tip: String,
}

impl Segment {
    /// A choice whose accessible name is its text.
    pub fn new(text: &str, tip: impl Into<String>) -> Self {
        Self { text: text.into(), name: text.into(), tip: tip.into() }
    }
}

/// Height of the control, in points.
const HEIGHT: f32 = 28.0;
/// Padding left and right of each text, in points.
const PADDING: f32 = 10.0;
/// The most by which a segment's padding, left plus right, shrinks if space is short, in points.
const MAX_SHRINK: f32 = 6.0;

/// Draws `segments` in a row and returns the index of the clicked one. The row is as wide as the texts need, or `width` points if
/// that is given, but never narrower than `MAX_SHRINK` allows.
pub fn segments_ui(
    ui: &mut Ui,
    id: &str,
    segments: &[Segment],
    selected: Option<usize>,
    width: Option<f32>,
) -> Option<usize> {
    let palette = Palette::from_ui(ui);
    let font = FontId::proportional(BODY);
    let texts: Vec<_> = segments
        .iter()
        .map(|s| ui.painter().layout_no_wrap(s.text.clone(), font.clone(), egui::Color32::PLACEHOLDER))
        .collect();
    let natural: f32 = texts.iter().map(|text| text.size().x.ceil() + 2.0 * PADDING).sum();
    let spare = width.map_or(0.0, |width| width - natural) / segments.len().max(1) as f32;
    let spare = spare.max(-MAX_SHRINK);
    let (whole, _) =
        ui.allocate_exact_size(vec2(natural + spare * segments.len() as f32, HEIGHT), Sense::hover());
    let radius = ui.visuals().widgets.inactive.corner_radius;
    ui.painter().rect(
        whole,
        radius,
        palette.background,
        Stroke::new(1.0, palette.border),
        StrokeKind::Inside,
    );
    let mut clicked = None;
    let mut left = whole.left();
    for (k, (segment, text)) in segments.iter().zip(texts).enumerate() {
        let size = vec2(text.size().x.ceil() + 2.0 * PADDING + spare, HEIGHT);
        let rect = Rect::from_min_size(egui::pos2(left, whole.top()), size);
        left = rect.right();
        let part = ui.new_child(UiBuilder::new().max_rect(rect));
        let response = part.interact(rect, Id::new(id).with(k), Sense::click());
        let chosen = selected == Some(k);
        response.widget_info(|| WidgetInfo::selected(WidgetType::RadioButton, true, chosen, &segment.name));
        let highlighted = response.hovered() || response.has_focus();
        if chosen {
            let stroke = Stroke::new(1.0, palette.accent);
            part.painter().rect(
                rect,
                radius,
                palette.selected_background(palette.control),
                stroke,
                StrokeKind::Inside,
            );
        } else if highlighted {
            part.painter().rect_filled(rect.shrink(2.0), radius, palette.control);
        }
        if response.has_focus() {
            part.painter().rect_stroke(rect, radius, Stroke::new(2.0, palette.accent), StrokeKind::Inside);
        }
        let color = if chosen { palette.accent } else { palette.text };
        let at = rect.center() - text.size() / 2.0;
        part.painter().galley(at, text, color);
        if response.clicked() {
            clicked = Some(k);
        }
        response.on_hover_text(&segment.tip).on_disabled_hover_text(&segment.tip);
    }
    clicked
}
