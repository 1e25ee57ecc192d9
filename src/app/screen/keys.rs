//! The keyboard: which key does what, in one table, and the doing of it.
//!
//! In: the keys of this frame. Out: orders, and changes of the desk. The tooltips and the help window read [`KEYS`].
//! Nothing is taken from a text field that is being written in; Tab and Space are left to egui once a control has the
//! focus (Shift+Tab goes there, Escape leaves).

use egui::{Event, Key, Modifiers, Ui};

use super::View;
use super::editor::{self, leave};
use crate::app::desk::{Camera, Desk, Look};
use crate::app::orders::{Order, Pace, Saved};

/// The paces that can be chosen, and how they are written.
pub const PACES: [(Pace, &str, &str); 5] = [
    (Pace::Times(1.0), "1×", "As it would be in reality"),
    (Pace::Times(5.0), "5×", "Five times as quickly as in reality"),
    (Pace::Times(20.0), "20×", "Twenty times as quickly"),
    (Pace::Times(100.0), "100×", "A hundred times as quickly"),
    (Pace::Full, "Full", "As quickly as it goes: to learn, not to watch"),
];

/// What a key does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Deed {
    /// Pause, or run.
    Pause,
    /// One control step.
    Step,
    /// One of [`PACES`]; with the digits, not in the table one by one.
    Pace,
    /// Arrow keys, in Drive mode.
    Steer,
    /// All arenas, or one.
    Grid,
    /// The next arena.
    Next,
    /// The whole enclosure.
    Fit,
    /// An overlay.
    Beams,
    /// An overlay.
    Path,
    /// An overlay.
    Trails,
    /// An overlay.
    Potential,
    /// An overlay.
    Value,
    /// An overlay.
    QValues,
    /// Into the editor, or out of it.
    Edit,
    /// Light or dark.
    Look,
    /// The help window.
    Help,
    /// Open a file.
    Open,
    /// Save the policy.
    Save,
}

/// A row of the table: what it does, the key as it is written, and in words.
pub struct Shortcut {
    /// What it does.
    pub deed: Deed,
    /// As it stands on the keyboard.
    pub key: &'static str,
    /// In words.
    pub what: &'static str,
    /// For `Ctrl` and the key (Command on a Mac).
    ctrl: bool,
    codes: &'static [Key],
}

const fn plain(deed: Deed, codes: &'static [Key], key: &'static str, what: &'static str) -> Shortcut {
    Shortcut { deed, key, what, ctrl: false, codes }
}

/// All of them, in the order in which they are listed.
pub const KEYS: [Shortcut; 18] = [
    plain(Deed::Pause, &[Key::Space], "Space", "Run or pause"),
    plain(Deed::Step, &[Key::Period], ".", "One control step, then stand still"),
    plain(Deed::Pace, &[], "1 … 5", "How quickly time passes"),
    plain(Deed::Steer, &[], "← ↑ →", "In Drive: steer; ↑ with ← or → turns gently"),
    plain(Deed::Grid, &[Key::G], "G", "All arenas, or one"),
    plain(Deed::Next, &[Key::Tab], "Tab", "Follow the next arena"),
    plain(Deed::Fit, &[Key::F], "F", "Show the whole enclosure"),
    plain(Deed::Beams, &[Key::B], "B", "LIDAR beams"),
    plain(Deed::Path, &[Key::W], "W", "Way driven"),
    plain(Deed::Trails, &[Key::T], "T", "Trails by outcome"),
    plain(Deed::Potential, &[Key::P], "P", "Potential field"),
    plain(Deed::Value, &[Key::V], "V", "Value by the network"),
    plain(Deed::QValues, &[Key::Q], "Q", "Q-values"),
    plain(Deed::Edit, &[Key::E], "E", "Edit the world, or leave the editor"),
    plain(Deed::Look, &[Key::L], "L", "Light or dark"),
    plain(Deed::Help, &[Key::H, Key::Questionmark], "H or ?", "This list"),
    Shortcut {
        deed: Deed::Open,
        key: "Ctrl+O",
        what: "Open a policy or a run",
        ctrl: true,
        codes: &[Key::O],
    },
    Shortcut { deed: Deed::Save, key: "Ctrl+S", what: "Save the policy", ctrl: true, codes: &[Key::S] },
];

/// How the key for `deed` is written.
pub fn key(deed: Deed) -> &'static str {
    KEYS.iter().find(|row| row.deed == deed).map_or("", |row| row.key)
}

/// `text`, and the key for `deed` after it.
pub fn tip(text: &str, deed: Deed) -> String {
    format!("{text}  ({})", key(deed))
}

/// Does what the keys of this frame ask for.
pub fn handle(ui: &mut Ui, view: &View<'_>, desk: &mut Desk, orders: &mut Vec<Order>) {
    let ctx = ui.ctx().clone();
    if ctx.text_edit_focused() {
        return;
    }
    if let Some(editor) = desk.editor.as_mut().filter(|_| !(desk.help_open || leave::is_asked(&ctx))) {
        editor::keys::handle(ui, editor, view.status, orders);
    }
    // In the editor the others are the editor's own, or of a world that can't be seen.
    let editing = desk.editor.is_some();
    let open =
        |row: &&Shortcut| !editing || matches!(row.deed, Deed::Fit | Deed::Edit | Deed::Look | Deed::Help);
    let focused = ctx.memory(|memory| memory.focused().is_some());
    let pressed = |row: &&Shortcut| {
        let modifiers = if row.ctrl { Modifiers::COMMAND } else { Modifiers::NONE };
        // A question mark needs Shift on most keyboards.
        let fits = |held: Modifiers, code: Key| {
            if code == Key::Questionmark { !held.command && !held.alt } else { held.matches_exact(modifiers) }
        };
        let ours = !(focused && matches!(row.deed, Deed::Pause | Deed::Next));
        ours && ctx.input(|i| {
            // Held down, only the step goes on and on.
            i.events.iter().any(|event| match *event {
                Event::Key { key, pressed: true, repeat, modifiers, .. } => {
                    row.codes.contains(&key) && fits(modifiers, key) && (!repeat || row.deed == Deed::Step)
                }
                _ => false,
            })
        })
    };
    for row in KEYS.iter().filter(open).filter(pressed) {
        if row.deed == Deed::Next {
            // Or egui would give the focus to its first control.
            ctx.memory_mut(|memory| memory.move_focus(egui::FocusDirection::None));
        }
        carry_out(ui, row.deed, view, desk, orders);
    }
    if editing {
        return;
    }
    let digits = [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5];
    for (code, (pace, ..)) in digits.into_iter().zip(PACES) {
        if ctx.input(|i| i.key_pressed(code) && i.modifiers.is_none()) {
            orders.push(Order::SetPace(pace));
        }
    }
}

fn carry_out(ui: &Ui, deed: Deed, view: &View<'_>, desk: &mut Desk, orders: &mut Vec<Order>) {
    let over = &mut desk.overlays;
    match deed {
        Deed::Pause => orders.push(Order::Pause(!view.status.paused)),
        Deed::Step => orders.push(Order::Step),
        Deed::Pace | Deed::Steer => {}
        Deed::Grid => desk.grid = !desk.grid,
        Deed::Next => desk.followed = (desk.followed + 1) % view.scene.arenas.len().max(1),
        Deed::Fit => desk.camera = Camera::default(),
        Deed::Beams => over.beams = !over.beams,
        Deed::Path => over.path = !over.path,
        Deed::Trails => over.trails = !over.trails,
        Deed::Potential => over.potential = !over.potential,
        Deed::Value => over.value = !over.value,
        Deed::QValues => over.q_values = !over.q_values,
        Deed::Edit if desk.editor.is_some() => leave::ask(ui.ctx(), desk, None, orders),
        Deed::Edit => leave::enter(ui.ctx(), view, desk, orders),
        Deed::Look => desk.look = if ui.visuals().dark_mode { Look::Light } else { Look::Dark },
        Deed::Help => desk.help_open = !desk.help_open,
        Deed::Open => orders.push(Order::OpenDialog),
        Deed::Save => orders.push(Order::SaveDialog(Saved::Policy)),
    }
}
