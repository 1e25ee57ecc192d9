//! Widgets shared by the panels, the plots, the arena view and the editor.
//!
//! | file | purpose |
//! |---|---|
//! | `icons.rs` | icons drawn with lines and discs, and the square buttons that show them |
//! | `buttons.rs` | the primary button and the full-width button |
//! | `question.rs` | a question in the middle of the window |
//! | `segments.rs` | a segmented control: one choice out of a few |
//! | `text.rs` | section titles, secondary text, notes, separators, key caps |

pub mod buttons;
pub mod icons;
pub mod question;
pub mod segments;
pub mod text;
