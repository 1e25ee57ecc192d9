//! How many autosaves and editor backups of earlier sessions are kept.

use std::cmp::Reverse;

/// The number that are kept, apart from those of running sessions.
const MAX_KEPT: usize = 3;

/// Sorts `found` by the `time` at which each was written, newest first. Removes all but the newest three, and passes them to
/// `delete`.
pub fn keep_newest<T, K: Ord>(found: &mut Vec<T>, time: impl Fn(&T) -> K, delete: impl FnMut(T)) {
    found.sort_by_key(|item| Reverse(time(item)));
    found.drain(MAX_KEPT.min(found.len())..).for_each(delete);
}
