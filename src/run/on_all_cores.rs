//! Work on all cores, with results in a fixed order.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::Builder;

/// Calls `compute` for the indices 0 to `count` - 1 on `threads` threads (0: one per core), and returns the results in this
/// order. Each thread first makes its own `state`. The number of threads changes no result, provided that `compute` does not
/// depend on what earlier calls left in the state.
pub fn map<S, T: Send>(
    count: usize,
    threads: usize,
    state: impl Fn() -> S + Sync,
    compute: impl Fn(&mut S, usize) -> T + Sync,
) -> Vec<T> {
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    let threads = if threads == 0 { cores() } else { threads }.min(count);
    // Some indices take a hundred times as long as others, so a thread takes one at a time.
    let next = AtomicUsize::new(0);
    let work = || {
        let mut state = state();
        let next_result = || {
            let index = next.fetch_add(1, Ordering::Relaxed);
            (index < count).then(|| (index, compute(&mut state, index)))
        };
        std::iter::from_fn(next_result).collect::<Vec<_>>()
    };
    let mut found: Vec<_> = std::thread::scope(|scope| {
        // This thread works too, so threads that cannot be started only cost time.
        let start = |_| Builder::new().spawn_scoped(scope, work).ok();
        let workers: Vec<_> = (1..threads).filter_map(start).collect();
        let mut found = work();
        for worker in workers {
            found.extend(worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
        }
        found
    });
    found.sort_by_key(|(index, _)| *index);
    found.into_iter().map(|(_, result)| result).collect()
}
