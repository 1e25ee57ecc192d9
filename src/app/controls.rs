//! The accessibility tree of the last frame, in which tests find controls by name.
//!
//! In: egui's output. Out: the rectangles of named controls. In the browser the page asks for one ([`find`]); a native app
//! writes them all to the file that the environment variable `WAYFIELD_CONTROLS` names ([`ControlsFile`]). egui builds no
//! tree before the first request.

#[cfg(not(target_arch = "wasm32"))]
use std::path::PathBuf;
#[cfg(target_arch = "wasm32")]
use std::sync::atomic::{AtomicBool, Ordering};
#[cfg(target_arch = "wasm32")]
use std::sync::{Mutex, PoisonError};

use bevy::prelude::*;
use bevy_egui::{EguiContext, EguiOutput};
use egui::accesskit::{Action, Node, Role, TreeUpdate};

#[cfg(target_arch = "wasm32")]
static REQUESTED: AtomicBool = AtomicBool::new(false);
#[cfg(target_arch = "wasm32")]
static TREE: Mutex<Option<TreeUpdate>> = Mutex::new(None);

/// Keeps the tree of this frame and requests the next one, once a control has been requested.
#[cfg(target_arch = "wasm32")]
pub fn keep_tree(contexts: Query<(&mut EguiContext, &mut EguiOutput)>) {
    if !REQUESTED.load(Ordering::Relaxed) {
        return;
    }
    if let Some(tree) = take_tree(contexts) {
        *TREE.lock().unwrap_or_else(PoisonError::into_inner) = Some(tree);
    }
}

/// Left, top, width and height, in points, of the enabled control or arena object with this accessible name. Of several,
/// the topmost, then the leftmost. `None` if there is none, or no tree yet: the first call requests it.
#[cfg(target_arch = "wasm32")]
pub fn find(name: &str) -> Option<[f64; 4]> {
    REQUESTED.store(true, Ordering::Relaxed);
    let tree = TREE.lock().unwrap_or_else(PoisonError::into_inner);
    named_controls(tree.as_ref()?).into_iter().find(|(other, _)| *other == name).map(|(_, rect)| rect)
}

/// The file to which a native app writes the rectangles of its named controls, one per line, in the order of [`find`]: left,
/// top, width, height, name, separated by tabs. It is replaced atomically whenever they change.
#[cfg(not(target_arch = "wasm32"))]
#[derive(Resource)]
pub struct ControlsFile {
    path: PathBuf,
    written: String,
}

#[cfg(not(target_arch = "wasm32"))]
impl ControlsFile {
    /// `None` unless the environment variable `WAYFIELD_CONTROLS` is set.
    pub fn from_env() -> Option<Self> {
        let path = std::env::var_os("WAYFIELD_CONTROLS")?;
        Some(Self { path: path.into(), written: String::new() })
    }
}

/// Writes the controls of this frame, if they differ from those written last.
#[cfg(not(target_arch = "wasm32"))]
pub fn write_controls(mut file: ResMut<ControlsFile>, contexts: Query<(&mut EguiContext, &mut EguiOutput)>) {
    let Some(tree) = take_tree(contexts) else { return };
    let line =
        |(name, [x, y, width, height]): (&str, [f64; 4])| format!("{x}\t{y}\t{width}\t{height}\t{name}\n");
    let text: String = named_controls(&tree).into_iter().map(line).collect();
    if text == file.written {
        return;
    }
    let temporary = file.path.with_extension("new");
    match std::fs::write(&temporary, &text).and_then(|()| std::fs::rename(&temporary, &file.path)) {
        Ok(()) => file.written = text,
        Err(error) => warn_once!("{}: {error}", file.path.display()),
    }
}

/// The tree of the frame that has just been drawn. Requests one for the next frame.
fn take_tree(mut contexts: Query<(&mut EguiContext, &mut EguiOutput)>) -> Option<TreeUpdate> {
    let mut tree = None;
    for (mut context, mut output) in &mut contexts {
        context.get_mut().enable_accesskit();
        tree = output.platform_output.accesskit_update.take().or(tree);
    }
    tree
}

/// The names and rectangles, in points, of all enabled controls and arena objects, sorted by top edge, then by left edge.
fn named_controls(tree: &TreeUpdate) -> Vec<(&str, [f64; 4])> {
    let usable = tree.nodes.iter().map(|(_, node)| node).filter(|node| is_usable(node));
    let named = usable.filter_map(|node| Some((accessible_name(tree, node)?, node.bounds()?)));
    let mut controls: Vec<_> =
        named.map(|(name, rect)| (name, [rect.x0, rect.y0, rect.width(), rect.height()])).collect();
    controls.sort_by(|(_, a), (_, b)| a[1].total_cmp(&b[1]).then(a[0].total_cmp(&b[0])));
    controls
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
