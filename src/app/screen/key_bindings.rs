//! The table of keyboard shortcuts, read by the keyboard handler, the tooltips and the help window.

use egui::Key;

use crate::app::commands::Pace;

/// The paces offered in the toolbar: pace, label, tooltip.
pub const PACES: [(Pace, &str, &str); 5] = [
    (Pace::Times(1.0), "1×", "Real time"),
    (Pace::Times(5.0), "5×", "5× real time"),
    (Pace::Times(20.0), "20×", "20× real time"),
    (Pace::Times(100.0), "100×", "100× real time"),
    (Pace::Full, "Full", "As fast as possible"),
];

/// The effect of a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shortcut {
    /// Pauses or resumes.
    Pause,
    /// Advances one control step.
    Step,
    /// Sets one of [`PACES`] by its number.
    Pace,
    /// Steers in Drive mode.
    Steer,
    /// Switches between one arena and the grid of all.
    Grid,
    /// Follows the next arena.
    Next,
    /// Fits the arena to the view.
    Fit,
    /// Toggles the LIDAR beams.
    Beams,
    /// Toggles the current path.
    Path,
    /// Toggles the past paths.
    Trails,
    /// Toggles the potential field.
    Potential,
    /// Toggles the state value.
    Value,
    /// Toggles the Q-values.
    QValues,
    /// Opens or closes the scenario editor.
    Edit,
    /// Switches between the light and the dark theme.
    Theme,
    /// Opens or closes the help window.
    Help,
    /// Opens a file.
    Open,
    /// Saves the policy.
    Save,
    /// Makes everything on the screen larger or smaller; handled by egui.
    Scale,
}

/// A row of the table of shortcuts.
pub struct KeyBinding {
    /// The effect.
    pub shortcut: Shortcut,
    /// The label of the key, as printed on a keyboard.
    pub key: &'static str,
    /// The effect, as listed in the help window.
    pub description: &'static str,
    /// Whether Ctrl (Command on a Mac) must be held.
    pub ctrl: bool,
    /// The keys that trigger it; empty if they are handled elsewhere (digits, arrows, scale).
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

const fn with_ctrl(
    shortcut: Shortcut,
    codes: &'static [Key],
    key: &'static str,
    description: &'static str,
) -> KeyBinding {
    KeyBinding { shortcut, key, description, ctrl: true, codes }
}

/// All shortcuts, in the order of the help window.
pub const KEY_BINDINGS: [KeyBinding; 19] = [
    plain(Shortcut::Pause, &[Key::Space], "Space", "Pause or resume"),
    plain(Shortcut::Step, &[Key::Period], ".", "Advance one control step"),
    plain(Shortcut::Pace, &[], "1 … 5", "Simulation speed"),
    plain(Shortcut::Steer, &[], "← ↑ →", "In Drive: steer; ↑ with ← or → turns gently"),
    plain(Shortcut::Grid, &[Key::G], "G", "Show one arena or all"),
    plain(Shortcut::Next, &[Key::Tab], "Tab", "Follow the next arena"),
    plain(Shortcut::Fit, &[Key::F], "F", "Fit the arena to the view"),
    plain(Shortcut::Beams, &[Key::B], "B", "LIDAR beams"),
    plain(Shortcut::Path, &[Key::W], "W", "Current path"),
    plain(Shortcut::Trails, &[Key::T], "T", "Past paths"),
    plain(Shortcut::Potential, &[Key::P], "P", "Potential field"),
    plain(Shortcut::Value, &[Key::V], "V", "State value"),
    plain(Shortcut::QValues, &[Key::Q], "Q", "Q-values"),
    plain(Shortcut::Edit, &[Key::E], "E", "Open or close the scenario editor"),
    plain(Shortcut::Theme, &[Key::L], "L", "Light or dark theme"),
    plain(Shortcut::Help, &[Key::H, Key::Questionmark], "H or ?", "Help and shortcuts"),
    with_ctrl(Shortcut::Open, &[Key::O], "Ctrl+O", "Open a policy or a run"),
    with_ctrl(Shortcut::Save, &[Key::S], "Ctrl+S", "Save the current policy"),
    with_ctrl(Shortcut::Scale, &[], "Ctrl +/−", "Larger or smaller text and controls"),
];

/// The label of the key for `shortcut`.
pub fn key_label(shortcut: Shortcut) -> &'static str {
    KEY_BINDINGS.iter().find(|row| row.shortcut == shortcut).map_or("", |row| row.key)
}

/// `text` followed by the key for `shortcut` in parentheses.
pub fn with_key_hint(text: &str, shortcut: Shortcut) -> String {
    format!("{text}  ({})", key_label(shortcut))
}
