//! Write points: named points between the writes of a run, where a test can abort the process.
//!
//! In: the environment variable `WAYFIELD_ABORT_AT`, which is `NAME` or `NAME:N`. Out: an abort the N-th time that the
//! process passes the write point `NAME` (by default the first time). `tests/cli_crash_recovery.rs` aborts a run at every
//! pass of every write point, and resumes it.

use std::sync::LazyLock;
use std::sync::atomic::{AtomicU64, Ordering};

/// The names of all write points.
pub const WRITE_POINTS: [&str; 10] = [
    "run folder: created",
    "file: temporary created",
    "file: contents written",
    "file: replaced",
    "checkpoint: state written",
    "checkpoint: renamed",
    "CSV: truncated",
    "CSV: flushed",
    "events: cut back",
    "events: created",
];

/// The variable's value; `None` if it is not set.
static ABORT_AT: LazyLock<Option<AbortAt>> =
    LazyLock::new(|| std::env::var("WAYFIELD_ABORT_AT").ok().map(|text| AbortAt::parse(&text)));

/// Marks a write point. Aborts the process without unwinding, as a crash does, if `WAYFIELD_ABORT_AT` names this pass.
/// Costs one atomic read if the variable is not set.
///
/// # Panics
/// The variable is set, and `name` is not in [`WRITE_POINTS`].
pub fn write_point(name: &str) {
    if let Some(abort_at) = &*ABORT_AT {
        assert!(WRITE_POINTS.contains(&name), "`{name}` is not in WRITE_POINTS");
        if abort_at.is_due(name) {
            std::process::abort();
        }
    }
}

/// The pass of a write point at which the process aborts.
struct AbortAt {
    name: String,
    /// The number of passes up to the abort.
    remaining: AtomicU64,
}

impl AbortAt {
    /// Parses `NAME` or `NAME:N`.
    fn parse(text: &str) -> Self {
        let numbered = text.rsplit_once(':').and_then(|(name, pass)| Some((name, pass.parse().ok()?)));
        let (name, pass) = numbered.unwrap_or((text, 1));
        Self { name: name.into(), remaining: AtomicU64::new(pass) }
    }

    /// Counts a pass of the point `name`. Returns whether the process must abort.
    fn is_due(&self, name: &str) -> bool {
        name == self.name && self.remaining.fetch_sub(1, Ordering::Relaxed) == 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_named_pass_of_the_named_point_is_due() {
        let passes = |text: &str| {
            let abort_at = AbortAt::parse(text);
            ["CSV: flushed", "file: replaced", "file: replaced", "file: replaced"]
                .map(|name| abort_at.is_due(name))
        };
        assert_eq!(passes("file: replaced"), [false, true, false, false]);
        assert_eq!(passes("file: replaced:2"), [false, false, true, false]);
        assert_eq!(passes("file: renamed:2"), [false; 4]);
    }
}
