//! A thread pool for large matrix products, even where no thread can be started.
//!
//! The gemm crate asks rayon for its global pool, and rayon panics if the pool cannot start its threads (because of a limit
//! on processes, such as `ulimit -u` or a container's). So the pool is started here first. If this fails, each thread that
//! multiplies gets its own pool, of that thread alone.

use std::cell::OnceCell;
use std::error::Error;
use std::sync::OnceLock;

use rayon::{ThreadPool, ThreadPoolBuilder};

/// Makes sure that the current thread has a pool. Call it before each matrix product.
pub(crate) fn ensure() {
    static HAS_GLOBAL: OnceLock<bool> = OnceLock::new();
    thread_local! {
        static OWN: OnceCell<Option<ThreadPool>> = const { OnceCell::new() };
    }
    let has_global = HAS_GLOBAL.get_or_init(|| match ThreadPoolBuilder::new().build_global() {
        Ok(()) => true,
        // An error without a source: another part of the program has already started the global pool.
        Err(error) => error.source().is_none(),
    });
    if !has_global {
        let alone = || ThreadPoolBuilder::new().num_threads(1).use_current_thread().build().ok();
        OWN.with(|own| {
            own.get_or_init(alone);
        });
    }
}
