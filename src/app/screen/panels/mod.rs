//! The panels: all that stands around the world in words and buttons.
//!
//! In: the status and the desk. Out: orders, and what the user looks at.
//!
//! | file | duty |
//! |---|---|
//! | `toolbar.rs` | the bar at the top: time, who drives |
//! | `readouts.rs` | its figures: how learning stands |
//! | `setup.rs` | the panel on the left, from top to bottom |
//! | `training.rs` | its first part: which world and learner, and beginning a training |
//! | `setup_form.rs` | what is chosen there but not yet begun |
//! | `overlays.rs` | the overlays' switches |
//! | `notices.rs` | what went as asked and what didn't |
//! | `help.rs` | what one sees, and the keys |
//! | `segments.rs`, `buttons.rs` | two controls: a few choices in a row; the primary button |

pub mod help;
pub mod notices;
mod overlays;
mod readouts;
pub mod setup;
pub mod toolbar;
mod training;
