//! The number of autosaves and editor backups of earlier sessions that are kept.

use std::cmp::Reverse;

/// The maximum number kept, not counting those of running sessions.
const MAX_KEPT: usize = 3;

/// Sorts `found` by the `time` at which each was written, newest first. Keeps only the newest `MAX_KEPT`, and passes the others
/// to `delete`.
pub fn keep_newest<T, K: Ord>(found: &mut Vec<T>, time: impl Fn(&T) -> K, delete: impl FnMut(T)) {
    found.sort_by_key(|item| Reverse(time(item)));
    found.drain(MAX_KEPT.min(found.len())..).for_each(delete);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_are_kept_and_the_others_deleted() {
        let (mut found, mut deleted) = (vec![3, 1, 5, 2, 4], Vec::new());
        keep_newest(&mut found, |time| *time, |time| deleted.push(time));
        assert_eq!((found, deleted), (vec![5, 4, 3], vec![2, 1]));
    }
}
