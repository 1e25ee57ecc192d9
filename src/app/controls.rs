//! The accessibility tree of the last frame, in which the page tests find controls by name.
//!
//! In: egui's output. Out: the rectangle of a named control. egui builds no tree before the first request.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use bevy::prelude::*;
use bevy_egui::{EguiContext, EguiOutput};
use egui::accesskit::{Action, Node, Role, TreeUpdate};

static REQUESTED: AtomicBool = AtomicBool::new(false);
static TREE: Mutex<Option<TreeUpdate>> = Mutex::new(None);

/// Keeps the tree of this frame and requests the next one, once somebody has asked for a control.
pub fn keep_tree(mut contexts: Query<(&mut EguiContext, &mut EguiOutput)>) {
    if !REQUESTED.load(Ordering::Relaxed) {
        return;
    }
    for (mut context, mut output) in &mut contexts {
        context.get_mut().enable_accesskit();
        if let Some(tree) = output.platform_output.accesskit_update.take() {
            *TREE.lock().unwrap_or_else(PoisonError::into_inner) = Some(tree);
        }
    }
}

/// Left, top, width and height, in points, of the enabled control or arena object with this accessible name. Of several,
/// the topmost, then the leftmost. `None` if there is none, and always before the next frame after the first call.
pub fn find(name: &str) -> Option<[f64; 4]> {
    REQUESTED.store(true, Ordering::Relaxed);
    let tree = TREE.lock().unwrap_or_else(PoisonError::into_inner);
    let tree = tree.as_ref()?;
    let named =
        tree.nodes.iter().filter(|(_, node)| is_usable(node) && accessible_name(tree, node) == Some(name));
    let rects = named.filter_map(|(_, node)| node.bounds());
    let first = rects.min_by(|a, b| a.y0.total_cmp(&b.y0).then(a.x0.total_cmp(&b.x0)))?;
    Some([first.x0, first.y0, first.width(), first.height()])
}

fn is_usable(node: &Node) -> bool {
    (node.supports_action(Action::Click) || node.role() == Role::GraphicsObject) && !node.is_disabled()
}

/// The node's own label, or else the text of the node that labels it.
fn accessible_name<'a>(tree: &'a TreeUpdate, node: &'a Node) -> Option<&'a str> {
    let labelling = || {
        let id = node.labelled_by().first()?;
        let (_, label) = tree.nodes.iter().find(|(other, _)| other == id)?;
        label.value().or(label.label())
    };
    node.label().or_else(labelling)
}
