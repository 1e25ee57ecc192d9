//! A segmented control: a few choices in a row, of which one at most is on.
//!
//! In: the choices and which one is on. Out: the one that was pressed.

use egui::{FontId, Id, Rect, Sense, Stroke, StrokeKind, Ui, UiBuilder, WidgetInfo, WidgetType, vec2};

use crate::app::screen::theme::{BODY, Palette};

/// One choice.
#[derive(Clone, Debug, PartialEq)]
pub struct Segment {
    /// What stands on it.
    pub text: String,
    /// What a screen reader calls it.
    pub name: String,
    /// What it does, in a sentence.
    pub tip: String,
}

impl Segment {
    /// One that can be pressed, and is called what stands on it.
    pub fn new(text: &str, tip: impl Into<String>) -> Self {
        Self { text: text.into(), name: text.into(), tip: tip.into() }
    }
}

const HEIGHT: f32 = 28.0;
const SIDE: f32 = 10.0;
/// What each may give away of that, both sides together, where there is little room.
const CLOSER: f32 = 6.0;

/// Draws them in a row, as wide as they need to be, or `width` in all, for which they come a little closer; answers with
/// the one that was pressed.
pub fn segments_ui(
    ui: &mut Ui,
    id: &str,
    segments: &[Segment],
    on: Option<usize>,
    width: Option<f32>,
) -> Option<usize> {
    let palette = Palette::from_ui(ui);
    let font = FontId::proportional(BODY);
    let texts: Vec<_> = segments
        .iter()
        .map(|s| ui.painter().layout_no_wrap(s.text.clone(), font.clone(), egui::Color32::PLACEHOLDER))
        .collect();
    let own: f32 = texts.iter().map(|text| text.size().x.ceil() + 2.0 * SIDE).sum();
    let spare = width.map_or(0.0, |width| width - own) / segments.len().max(1) as f32;
    let spare = spare.max(-CLOSER);
    let (whole, _) =
        ui.allocate_exact_size(vec2(own + spare * segments.len() as f32, HEIGHT), Sense::hover());
    let radius = ui.visuals().widgets.inactive.corner_radius;
    ui.painter().rect(
        whole,
        radius,
        palette.background,
        Stroke::new(1.0, palette.border),
        StrokeKind::Inside,
    );
    let mut pressed = None;
    let mut left = whole.left();
    for (k, (segment, text)) in segments.iter().zip(texts).enumerate() {
        let size = vec2(text.size().x.ceil() + 2.0 * SIDE + spare, HEIGHT);
        let rect = Rect::from_min_size(egui::pos2(left, whole.top()), size);
        left = rect.right();
        let part = ui.new_child(UiBuilder::new().max_rect(rect));
        let response = part.interact(rect, Id::new(id).with(k), Sense::click());
        let chosen = on == Some(k);
        response.widget_info(|| WidgetInfo::selected(WidgetType::RadioButton, true, chosen, &segment.name));
        let lit = response.hovered() || response.has_focus();
        if chosen {
            let stroke = Stroke::new(1.0, palette.accent);
            part.painter().rect(
                rect,
                radius,
                palette.selected_background(palette.control),
                stroke,
                StrokeKind::Inside,
            );
        } else if lit {
            part.painter().rect_filled(rect.shrink(2.0), radius, palette.control);
        }
        if response.has_focus() {
            part.painter().rect_stroke(rect, radius, Stroke::new(2.0, palette.accent), StrokeKind::Inside);
        }
        let ink = if chosen { palette.accent } else { palette.text };
        let at = rect.center() - text.size() / 2.0;
        part.painter().galley(at, text, ink);
        if response.clicked() {
            pressed = Some(k);
        }
        response.on_hover_text(&segment.tip).on_disabled_hover_text(&segment.tip);
    }
    pressed
}
