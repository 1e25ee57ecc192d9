//! Offers over the top of the arena: to continue the last session, and to restore unsaved changes of the editor.

use egui::{Align2, Area, Button, Frame, Id, Margin, Rect, RichText, Stroke, Ui, vec2};

use crate::app::app_status::{AppStatus, LastSession, UnsavedEdits};
use crate::app::commands::Command;
use crate::app::editor::Editor;
use crate::app::screen::numbers;
use crate::app::screen::theme::{BODY, GAP, Palette};
use crate::app::screen::widgets::buttons::primary_button_ui;
use crate::app::screen::widgets::text::weak_text;

const WIDTH: f32 = 300.0;
const BUTTON_HEIGHT: f32 = 28.0;

/// An offer that the user accepts or dismisses.
struct Offer {
    question: &'static str,
    details: String,
    accept: (&'static str, Command),
    dismiss: Command,
}

/// Draws an offer over the top of `arena`, until the user has decided. Unsaved changes are offered first, but not while an open
/// `editor` has unsaved changes itself. The last session is offered only while no editor is open.
pub fn offers_ui(
    ui: &Ui,
    arena: Rect,
    status: &AppStatus,
    editor: Option<&Editor>,
    commands: &mut Vec<Command>,
) {
    let edits = status.unsaved_edits.as_ref().filter(|_| editor.is_none_or(|editor| !editor.is_modified()));
    let session = status.last_session.as_ref().filter(|_| editor.is_none());
    if let Some(UnsavedEdits { scenario, age_s }) = edits {
        let offer = Offer {
            question: "Restore the unsaved scenario?",
            details: format!("{scenario} · {}", age(*age_s)),
            accept: ("Restore", Command::RestoreEdits),
            dismiss: Command::DismissEdits,
        };
        offer_ui(ui, arena, offer, commands);
    } else if let Some(session) = session {
        let offer = Offer {
            question: "Continue where you left off?",
            details: describe(session),
            accept: ("Continue", Command::ContinueLastSession),
            dismiss: Command::DismissLastSession,
        };
        offer_ui(ui, arena, offer, commands);
    }
}

fn offer_ui(ui: &Ui, arena: Rect, offer: Offer, commands: &mut Vec<Command>) {
    let palette = Palette::from_ui(ui);
    let area = Area::new(Id::new("offer")).pivot(Align2::CENTER_TOP);
    area.fixed_pos(arena.center_top() + vec2(0.0, 2.0 * GAP)).constrain_to(arena).show(ui.ctx(), |ui| {
        let frame = Frame::new()
            .fill(palette.panel)
            .stroke(Stroke::new(1.0, palette.accent))
            .corner_radius(8.0)
            .shadow(ui.visuals().popup_shadow)
            .inner_margin(Margin::same(12));
        frame.show(ui, |ui| {
            ui.set_width(WIDTH.min(arena.width() - 6.0 * GAP).max(180.0));
            ui.label(RichText::new(offer.question).size(BODY).color(palette.text));
            ui.label(weak_text(&offer.details));
            ui.add_space(GAP);
            ui.horizontal(|ui| {
                let size = vec2((ui.available_width() - ui.spacing().item_spacing.x) / 2.0, BUTTON_HEIGHT);
                if primary_button_ui(ui, offer.accept.0, BODY, size).clicked() {
                    commands.push(offer.accept.1);
                }
                if ui.add_sized(size, Button::new("Not now")).clicked() {
                    commands.push(offer.dismiss);
                }
            });
        });
    });
}

/// The session in words: `Scenario I, Fast, seed 0 · 123,456 steps · 3 min ago`.
fn describe(session: &LastSession) -> String {
    let LastSession { scenario, preset, seed, env_steps, age_s } = session;
    let steps = numbers::format_count(*env_steps);
    format!("{scenario}, {preset}, seed {seed} · {steps} steps · {}", age(*age_s))
}

/// A time `seconds` ago, in words.
fn age(seconds: u64) -> String {
    match seconds {
        0..60 => "just now".into(),
        60..3600 => format!("{} min ago", seconds / 60),
        3600..86_400 => format!("{} h ago", seconds / 3600),
        86_400..172_800 => "yesterday".into(),
        _ => format!("{} days ago", seconds / 86_400),
    }
}
