//! The editor: a scenario as a document, edited while another scenario may be running.
//!
//! In: pointer positions and field values from the screen. Out: the edited [`Scenario`](crate::scenario::Scenario), its
//! diagnostics after every change, and undo. The editor draws nothing and does not touch the running scenario. Positions
//! are in m, angles in rad.
//!
//! | file | purpose |
//! |---|---|
//! | `document.rs` | the [`Editor`]: the scenario, the selection, the diagnostics, one undo step per change |
//! | `selection.rs`, `pick.rs` | the selection; the item under the pointer |
//! | `items/` | the items that can be selected, one file per kind |
//! | `handle.rs`, `drag.rs`, `dragging.rs` | handles; one drag; dragging and nudging the selected item |
//! | `tool.rs`, `drawing_tools.rs` | drawing walls, paths and positions click by click |
//! | `new_items.rs`, `free_space.rs`, `clipboard.rs` | add, copy, paste, delete; free space for new items |
//! | `kinds.rs`, `set_kind.rs`, `new_motion.rs` | kinds of placement and enclosure; changing these and the kind of a motion |
//! | `undo.rs` | undo and redo |
//! | `saving.rs` | the file, and whether the scenario is saved |
//! | `interaction.rs` | the user's unfinished actions: a pressed item, open questions |
//! | `points.rs`, `snap.rs`, `limits.rs` | positions and their texts, snapping, limits and defaults |

mod clipboard;
mod document;
mod drag;
mod dragging;
mod drawing_tools;
mod free_space;
mod handle;
mod interaction;
mod items;
mod kinds;
mod limits;
mod new_items;
mod new_motion;
mod pick;
mod points;
mod saving;
mod selection;
mod set_kind;
mod snap;
#[cfg(test)]
mod tests;
mod tool;
mod undo;

pub use document::Editor;
pub use handle::{Handle, HandleKind};
pub use interaction::{EditorInteraction, ExitRequest, PointerHit, Press};
pub use items::Body;
pub use kinds::{EnclosureKind, PlacementKind, PlacementRole};
pub use points::format_metres;
pub use selection::Selection;
pub use snap::Snap;
pub use tool::Tool;
