//! The panels: toolbar, setup panel, notices and help window.
//!
//! In: the session state and the [`ViewState`](crate::app::view_state::ViewState). Out: commands, and changes
//! to the view state.
//!
//! | file | purpose |
//! |---|---|
//! | `toolbar.rs` | the toolbar at the top: layout, run and step buttons, pace, panel buttons |
//! | `mode_switch.rs` | the toolbar's choice of mode: Train, Test, Drive, Compare, Edit |
//! | `readouts.rs` | the toolbar's numbers: success rate, steps, speed |
//! | `setup.rs` | the setup panel on the left |
//! | `training.rs` | the setup panel's first section: the choices, and the buttons that start training |
//! | `choices.rs`, `seed.rs` | the choices of scenario, learner and seed |
//! | `discard_question.rs` | the question before a training run is discarded |
//! | `tested_policy.rs` | the setup panel's choice of the policy to test |
//! | `files.rs` | the setup panel's buttons that open and save files |
//! | `overlays.rs` | the setup panel's switches for the overlays |
//! | `notices.rs` | notices over the arena |
//! | `offers.rs` | the offers to continue the last session, and to restore unsaved changes of the editor |
//! | `quit_question.rs` | the question before quitting |
//! | `help.rs` | the help window |

mod choices;
mod discard_question;
mod files;
pub mod help;
mod mode_switch;
pub mod notices;
pub mod offers;
mod overlays;
pub mod quit_question;
mod readouts;
mod seed;
pub mod setup;
mod tested_policy;
pub mod toolbar;
mod training;
