//! The readouts on the right of the toolbar: success rate, steps and speed, as many as fit.

use egui::{Align2, FontId, Response, Sense, Ui, WidgetInfo, WidgetType, pos2, vec2};

use crate::app::app_status::AppStatus;
use crate::app::screen::numbers;
use crate::app::screen::theme::{BODY, DISPLAY, GAP, Palette, SMALL};

/// A number with its caption.
struct Readout {
    value: String,
    caption: String,
    tip: String,
    width: f32,
    large: bool,
    /// Whether there is a value yet.
    known: bool,
}

impl Readout {
    fn new(value: String, caption: impl Into<String>, width: f32, tip: String) -> Self {
        Self { value, caption: caption.into(), tip, width, large: false, known: true }
    }
}

const HEIGHT: f32 = 40.0;

/// Draws as many readouts as fit, the most important first; `ui` must lay out from right to left. `tight`
/// saves space in the toolbar of a narrow window.
pub fn readouts_ui(ui: &mut Ui, status: &AppStatus, tight: bool) {
    // In a tight toolbar there is no gap after the last readout.
    let mut free = ui.available_width() + if tight { 2.0 * GAP } else { 0.0 };
    let mut fit: Vec<(usize, Readout)> = Vec::new();
    // Ordered by importance; the index counts from the right.
    for (from_right, readout) in [
        (0, success(status, if tight { 68.0 } else { 84.0 })),
        (3, episodes(status)),
        (2, env_steps(status)),
        (1, speed(status)),
        (4, frames(status)),
    ] {
        let needs = readout.width + 2.0 * GAP;
        if needs > free {
            break;
        }
        free -= needs;
        fit.push((from_right, readout));
    }
    fit.sort_by_key(|(from_right, _)| *from_right);
    ui.spacing_mut().item_spacing.x = 2.0 * GAP;
    for (_, readout) in &fit {
        readout_ui(ui, readout).on_hover_text(&readout.tip);
    }
}

fn readout_ui(ui: &mut Ui, readout: &Readout) -> Response {
    let palette = Palette::from_ui(ui);
    let (rect, response) = ui.allocate_exact_size(vec2(readout.width, HEIGHT), Sense::hover());
    let words = format!("{} {}", readout.caption, readout.value);
    response.widget_info(|| WidgetInfo::labeled(WidgetType::Label, true, &words));
    let (size, color) = if readout.large {
        (DISPLAY, if readout.known { palette.accent } else { palette.weak_text })
    } else {
        (BODY, palette.text)
    };
    // Captions share a baseline, and so do numbers; the larger font needs a shift by its descenders.
    let text = |y, words: &String, size, color| {
        ui.painter().text(
            pos2(rect.left(), y),
            Align2::LEFT_BOTTOM,
            words,
            FontId::proportional(size),
            color,
        );
    };
    let bottom = rect.bottom() - 3.0;
    text(bottom - 15.0 + (size - BODY) * 0.24, &readout.value, size, color);
    text(bottom, &readout.caption, SMALL, palette.weak_text);
    response
}

fn success(status: &AppStatus, width: f32) -> Readout {
    let value = status.success_rate.map_or("–".into(), numbers::format_percent);
    let tip = match (status.success_rate, status.best) {
        (Some(_), Some(best)) => format!(
            "Share of goals reached in the last evaluation, without random actions. Best so far: {} at {} env steps",
            numbers::format_percent(best.success_rate),
            numbers::format_count(best.env_steps)
        ),
        (Some(_), None) => "Share of goals reached in the last evaluation, without random actions".into(),
        (None, _) => "Share of goals reached without random actions. No evaluation yet".into(),
    };
    Readout {
        large: true,
        known: status.success_rate.is_some(),
        ..Readout::new(value, "success rate", width, tip)
    }
}

fn episodes(status: &AppStatus) -> Readout {
    let tip = "Episodes that a collision or the time limit ended, in all arenas together".into();
    Readout::new(numbers::format_count(status.episodes), "episodes", 52.0, tip)
}

fn env_steps(status: &AppStatus) -> Readout {
    let more = status.budget_env_steps.map_or_else(String::new, |budget| {
        format!(
            ". The preset's budget is {}; here training continues beyond it",
            numbers::format_count(budget)
        )
    });
    let tip = format!(
        "Control steps of all arenas together. Gradient steps: {}{more}",
        numbers::format_count(status.gradient_steps)
    );
    Readout::new(numbers::format_count(status.env_steps), "env steps", 56.0, tip)
}

fn speed(status: &AppStatus) -> Readout {
    let tip = format!(
        "Env steps per second of wall time, and speed of one arena relative to real time. Simulated per arena: {}",
        duration(status.simulated_s)
    );
    let value = if status.paused {
        "paused".into()
    } else {
        format!("{} steps/s", numbers::format_rate(status.env_steps_per_s))
    };
    let caption = if status.paused {
        format!("{} simulated", short_duration(status.simulated_s))
    } else {
        format!("{} real time", numbers::format_factor(status.real_time_factor))
    };
    Readout::new(value, caption, 92.0, tip)
}

fn frames(status: &AppStatus) -> Readout {
    let tip = "Frames drawn per second".into();
    Readout::new(numbers::format_rate(status.frames_per_s), "fps", 26.0, tip)
}

/// A duration of `s` seconds in one unit: 42 s, 3 min, 2.2 h.
fn short_duration(s: f64) -> String {
    let s = s.max(0.0).round();
    match s {
        _ if s < 60.0 => format!("{s:.0} s"),
        _ if s < 3600.0 => format!("{} min", (s / 60.0) as u64),
        _ if s < 360_000.0 => format!("{:.1} h", s / 3600.0),
        _ => format!("{} h", numbers::format_rate(s / 3600.0)),
    }
}

/// A duration of `s` seconds in hours and minutes: 42 s, 3 min, 2 h 10 min.
fn duration(s: f64) -> String {
    let s = s.max(0.0).round();
    let minutes = (s / 60.0) as u64;
    match minutes {
        0 => format!("{s:.0} s"),
        1..60 => format!("{minutes} min"),
        _ => format!("{} h {} min", minutes / 60, minutes % 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_never_show_sixty_seconds() {
        assert_eq!([59.4, 59.5, 3599.0].map(duration), ["59 s", "1 min", "59 min"]);
        assert_eq!([59.4, 59.5, 7_920.0].map(short_duration), ["59 s", "1 min", "2.2 h"]);
    }
}
