//! Figures and tables from run folders, as files.
//!
//! In: the records a run leaves behind. Out: text in a file's format, the same for the same records: nothing
//! here looks at a clock, so a figure changes only when its numbers do.
//!
//! | figure | what it shows |
//! |---|---|
//! | [`learning_curve`] | success, return and targets of one run, over its environment steps |

pub mod learning_curve;
