//! The choice of panel below the arena in a narrow window, where only one has room.

use crate::app::view_state::ViewState;

/// What can be seen below the world in a narrow window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BottomPanel {
    Setup,
    Plots,
}

/// What is seen there: one of the panels that are open, the plots before the setup, but not before the editor's.
pub fn visible_bottom_panel(view_state: &ViewState) -> Option<BottomPanel> {
    let panel_first = view_state.editor.is_some() && view_state.setup_open;
    if view_state.plots_open && !panel_first {
        Some(BottomPanel::Plots)
    } else {
        view_state.setup_open.then_some(BottomPanel::Setup)
    }
}
