//! The table of keyboard shortcuts, read by the keyboard handler, the tooltips and the help window.

use egui::Key;

use crate::app::commands::Pace;

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
pub enum Shortcut {
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
    ThemeChoice,
    /// The help window.
    Help,
    /// Open a file.
    Open,
    /// Save the policy.
    Save,
}

/// A row of the table: what it does, the key as it is written, and in words.
pub struct KeyBinding {
    /// What it does.
    pub shortcut: Shortcut,
    /// As it stands on the keyboard.
    pub key: &'static str,
    /// In words.
    pub description: &'static str,
    /// For `Ctrl` and the key (Command on a Mac).
    pub ctrl: bool,
    /// The keys that trigger it; empty where `shortcuts.rs` handles them one by one.
    pub codes: &'static [Key],
}

const fn plain(
    shortcut: Shortcut,
    codes: &'static [Key],
    key: &'static str,
    description: &'static str,
) -> KeyBinding {
    KeyBinding { shortcut, key, description, ctrl: false, codes }
}

/// All of them, in the order in which they are listed.
pub const KEY_BINDINGS: [KeyBinding; 18] = [
    plain(Shortcut::Pause, &[Key::Space], "Space", "Run or pause"),
    plain(Shortcut::Step, &[Key::Period], ".", "One control step, then stand still"),
    plain(Shortcut::Pace, &[], "1 … 5", "How quickly time passes"),
    plain(Shortcut::Steer, &[], "← ↑ →", "In Drive: steer; ↑ with ← or → turns gently"),
    plain(Shortcut::Grid, &[Key::G], "G", "All arenas, or one"),
    plain(Shortcut::Next, &[Key::Tab], "Tab", "Follow the next arena"),
    plain(Shortcut::Fit, &[Key::F], "F", "Show the whole enclosure"),
    plain(Shortcut::Beams, &[Key::B], "B", "LIDAR beams"),
    plain(Shortcut::Path, &[Key::W], "W", "Way driven"),
    plain(Shortcut::Trails, &[Key::T], "T", "Trails by outcome"),
    plain(Shortcut::Potential, &[Key::P], "P", "Potential field"),
    plain(Shortcut::Value, &[Key::V], "V", "Value by the network"),
    plain(Shortcut::QValues, &[Key::Q], "Q", "Q-values"),
    plain(Shortcut::Edit, &[Key::E], "E", "Edit the world, or leave the editor"),
    plain(Shortcut::ThemeChoice, &[Key::L], "L", "Light or dark"),
    plain(Shortcut::Help, &[Key::H, Key::Questionmark], "H or ?", "This list"),
    KeyBinding {
        shortcut: Shortcut::Open,
        key: "Ctrl+O",
        description: "Open a policy or a run",
        ctrl: true,
        codes: &[Key::O],
    },
    KeyBinding {
        shortcut: Shortcut::Save,
        key: "Ctrl+S",
        description: "Save the policy",
        ctrl: true,
        codes: &[Key::S],
    },
];

/// How the key for `shortcut` is written.
pub fn key_label(shortcut: Shortcut) -> &'static str {
    KEY_BINDINGS.iter().find(|row| row.shortcut == shortcut).map_or("", |row| row.key)
}

/// `text`, and the key for `shortcut` after it.
pub fn with_key_hint(text: &str, shortcut: Shortcut) -> String {
    format!("{text}  ({})", key_label(shortcut))
}
