//! The choice of panel below the arena in a narrow window, where only one fits.

use crate::app::view_state::ViewState;

/// The panel below the arena in a narrow window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BottomPanel {
    /// The setup panel, or the panel of the editor.
    Setup,
    /// The learning curves.
    Plots,
}

/// The panel shown below the arena, if one is open. If both are open, the plots take precedence over the setup panel, and the
/// editor's panel takes precedence over the plots.
pub fn visible_bottom_panel(view_state: &ViewState) -> Option<BottomPanel> {
    let editor_panel_open = view_state.editor.is_some() && view_state.setup_open;
    if view_state.plots_open && !editor_panel_open {
        Some(BottomPanel::Plots)
    } else {
        view_state.setup_open.then_some(BottomPanel::Setup)
    }
}
