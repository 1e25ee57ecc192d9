//! The drawing of a plot card: title, legend, and a plot over env steps.
//!
//! In: a [`Card`] with borrowed series. Out: shapes, and the pointer's position on the x axis. All cards
//! share that axis: panning or zooming one moves all, and each shows its values at the pointer.

use egui::{Color32, FontId, Rect, Sense, Stroke, Vec2, vec2};
use egui_plot::{AxisHints, HLine, Line, LineStyle, Plot, PlotPoints, PlotUi, Points, VLine};

use super::axis;
use super::band::Band;
use super::caption::{heading_ui, legend_ui, value_at};
use super::card::{Card, CardContext, CardResponse, Trace, TraceStyle};
use super::marks::label_marks;
use crate::app::screen::theme::{Palette, SMALL};

/// The height of a plot including its axis, in points.
const HEIGHT: f32 = 112.0;
/// The width of the y axis, in points; equal on all cards, so that the plots are aligned.
const AXIS_WIDTH: f32 = 44.0;
/// The radius of the ring around the best point, in points.
const RING_RADIUS: f32 = 4.5;
/// The maximum number of points at which a line is drawn with dots.
const MAX_DOTS: usize = 40;

/// Draws a card; `labelled` adds the texts of the vertical marks.
pub fn card_ui(ui: &mut egui::Ui, card: &Card<'_>, shared: &CardContext<'_>, labelled: bool) -> CardResponse {
    let palette = Palette::from_ui(ui);
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = 1.0;
        ui.spacing_mut().interact_size.y = 0.0;
        heading_ui(ui, card, shared, palette);
        legend_ui(ui, card, shared, palette);
        ui.add_space(2.0);
        let size = vec2(ui.available_width(), HEIGHT);
        let rect = Rect::from_min_size(ui.cursor().min, size);
        if card.traces.iter().all(|trace| trace.series.points().is_empty()) {
            empty_card_ui(ui, card.empty_text, size, palette);
            CardResponse::default()
        } else if ui.is_rect_visible(rect) {
            plot_ui(ui, card, shared, labelled, palette)
        } else {
            ui.allocate_space(size);
            CardResponse::default()
        }
    })
    .inner
}

/// Draws the placeholder of a card without data: `text` between two lines.
fn empty_card_ui(ui: &mut egui::Ui, text: &str, size: Vec2, palette: Palette) {
    let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
    let area = rect.with_min_x(rect.left() + AXIS_WIDTH).with_max_y(rect.bottom() - 14.0);
    for y in [area.top() + 4.0, area.bottom() - 4.0] {
        ui.painter().hline(area.x_range(), y, Stroke::new(1.0, palette.border));
    }
    let font = FontId::proportional(SMALL);
    ui.painter().text(area.center(), egui::Align2::CENTER_CENTER, text, font, palette.weak_text);
}

/// Draws the plot of a card.
fn plot_ui(
    ui: &mut egui::Ui,
    card: &Card<'_>,
    shared: &CardContext<'_>,
    labelled: bool,
    palette: Palette,
) -> CardResponse {
    let frame = configure(card, shared, palette).show(ui, |plot| {
        if shared.reset {
            plot.set_auto_bounds(true);
        } else if !plot.auto_bounds().x {
            keep_in_range(plot, shared.range);
        }
        let mark_color = palette.weak_text.gamma_multiply(if labelled { 0.8 } else { 0.45 });
        for mark in shared.marks {
            let line = VLine::new("", mark.env_steps as f64).allow_hover(false);
            plot.vline(line.stroke(Stroke::new(1.0, mark_color)).style(LineStyle::dashed_dense()));
        }
        if let Some(reference) = card.reference {
            let line = HLine::new("", reference.value).allow_hover(false).style(LineStyle::dashed_loose());
            plot.hline(line.stroke(Stroke::new(1.0, palette.weak_text)));
        }
        for trace in card.traces.iter().rev() {
            draw(plot, trace);
        }
        if let Some((x, y)) = card.ring {
            let ring = Points::new("", [x, y]).allow_hover(false).filled(false);
            plot.points(ring.radius(RING_RADIUS).color(palette.success));
        }
        !plot.auto_bounds().x
    });
    if labelled {
        label_marks(ui, &frame.transform, shared.marks, palette);
    }
    let pointer = frame.response.hover_pos();
    let hovered = pointer.map(|at| frame.transform.value_from_position(at).x);
    CardResponse { hovered, zoomed: frame.inner }
}

/// An empty plot with the axes, the bounds and the interactions of a card.
fn configure<'a>(card: &'a Card<'_>, shared: &CardContext<'_>, palette: Palette) -> Plot<'a> {
    let scale = card.scale;
    let group = "learning";
    let plot = Plot::new(card.title)
        .height(HEIGHT)
        // Without zoom there is nothing to drag, and a swipe scrolls the list of plots instead.
        .sense(if shared.zoomed { Sense::click_and_drag() } else { Sense::click() })
        .allow_drag([shared.zoomed, false])
        .allow_zoom([true, false])
        .allow_scroll(false)
        .allow_axis_zoom_drag(false)
        .allow_boxed_zoom(false)
        .link_axis(group, [true, false])
        .link_cursor(group, [true, false])
        .cursor_color(palette.text.gamma_multiply(0.5))
        .show_y(false)
        .show_background(false)
        .grid_color(palette.border)
        .grid_fade(0.0)
        .set_margin_fraction(vec2(0.0, 0.06))
        .include_x(shared.range.0)
        .include_x(shared.range.1)
        .custom_x_axes(vec![
            axis_hints(AxisHints::new_x(), palette)
                .formatter(|mark, _| axis::env_steps_label(mark.value, mark.step_size)),
        ])
        .custom_y_axes(vec![
            axis_hints(AxisHints::new_y(), palette)
                .min_thickness(AXIS_WIDTH)
                .formatter(move |mark, _| scale.tick_label(mark.value, mark.step_size)),
        ])
        .x_grid_spacer(|input| axis::round_grid_marks(input.bounds, 4.0))
        .y_grid_spacer(move |input| scale.grid_marks(input.bounds))
        .label_formatter(|pointer| tooltip(card, pointer));
    match scale.fixed_range() {
        Some((low, high)) => plot.default_y_bounds(low, high),
        None => scale
            .included_values(
                card.traces.iter().map(|trace| trace.series),
                card.reference.map(|reference| reference.value),
            )
            .into_iter()
            .fold(plot, Plot::include_y),
    }
}

fn axis_hints(hints: AxisHints<'static>, palette: Palette) -> AxisHints<'static> {
    let hints = hints.tick_label_font(FontId::proportional(SMALL)).tick_label_color(palette.weak_text);
    hints.label_spacing(egui::Rangef::new(0.0, 1.0))
}

/// Moves the visible part of the x axis back into the range of the data. If it covers the whole range, the plot
/// follows new data again.
fn keep_in_range(plot: &mut PlotUi<'_>, (from, to): (f64, f64)) {
    let visible = plot.plot_bounds();
    let (low, width) = (visible.min()[0], visible.width());
    if width >= to - from {
        plot.set_auto_bounds(true);
    } else if low < from {
        plot.set_plot_bounds_x(from..=from + width);
    } else if low + width > to {
        plot.set_plot_bounds_x(to - width..=to);
    }
}

/// Draws a line of a card in its style.
fn draw<'a>(plot: &mut PlotUi<'a>, trace: &Trace<'a>) {
    let points = trace.series.points();
    let line = |width: f32, color: Color32| {
        Line::new(trace.name, PlotPoints::Borrowed(points))
            .stroke(Stroke::new(width, color))
            .allow_hover(false)
    };
    match trace.style {
        TraceStyle::Spread if trace.series.is_full_resolution() => {
            let dots = Points::new(trace.name, PlotPoints::Borrowed(points)).allow_hover(false);
            plot.points(dots.radius(1.2).color(trace.color.gamma_multiply(0.5)));
        }
        TraceStyle::Spread => plot.add(Band::new(trace.series, trace.color.gamma_multiply(0.3))),
        TraceStyle::Faint | TraceStyle::Earlier => plot.line(line(1.2, trace.color)),
        TraceStyle::Main => plot.line(line(1.8, trace.color)),
        TraceStyle::Dots => {
            plot.line(line(1.8, trace.color));
            if points.len() <= MAX_DOTS {
                let dots = Points::new(trace.name, PlotPoints::Borrowed(points)).allow_hover(false);
                plot.points(dots.radius(2.2).color(trace.color));
            }
        }
    }
}

/// The tooltip: the values of the lines at the pointer.
fn tooltip(card: &Card<'_>, pointer: &egui_plot::HoverPosition<'_>) -> Option<String> {
    let (egui_plot::HoverPosition::NearDataPoint { position, .. }
    | egui_plot::HoverPosition::Elsewhere { position }) = pointer;
    let lines = || card.traces.iter().filter(|trace| trace.style != TraceStyle::Spread);
    let named = lines().count() > 1;
    let values = lines().filter_map(|trace| {
        let value = value_at(card, trace, Some(position.x))?;
        Some(if named { format!("{} {value}", trace.name) } else { value })
    });
    let values: Vec<_> = values.collect();
    Some(format!("at {}:  {}", axis::format_env_steps(position.x.max(0.0)), values.join(",  ")))
}
