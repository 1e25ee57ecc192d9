//! The kinds of processor that a run was trained on, in the file `processors.json` of its folder. The last bits of weights
//! depend on them (`docs/determinism.md`).

use std::io::Write as _;
use std::path::Path;
use std::sync::OnceLock;

use super::RunError;
use super::folder::RunFolder;
use crate::scenario::read_text_with_limit;

/// The file in a run folder: the kinds of processor in the order of their use, as JSON.
pub const PROCESSORS_FILE: &str = "processors.json";
/// Maximum size of this file when it is read, in bytes.
const MAX_BYTES: u64 = 1 << 16;

/// Records in the run folder `folder` that this machine trains the run from now on.
///
/// # Errors
/// The file cannot be written.
pub fn record(folder: &RunFolder) -> Result<(), RunError> {
    let mut kinds = read(folder.path());
    let this = this_processor();
    if kinds.last().is_some_and(|last| last == this) {
        return Ok(());
    }
    kinds.push(this.into());
    let text = serde_json::to_string(&kinds).map_err(|error| RunError::Failed(error.to_string()))?;
    folder.write(PROCESSORS_FILE, |file| file.write_all(text.as_bytes()))
}

/// The kinds of processor that the run in `folder` was trained on; empty if nothing is recorded.
#[must_use]
pub fn read(folder: &Path) -> Vec<String> {
    let text = read_text_with_limit(folder.join(PROCESSORS_FILE), MAX_BYTES).unwrap_or_default();
    serde_json::from_str(&text).unwrap_or_default()
}

/// The processor of this machine with the instruction set that decides how matrix products are summed, such as "AMD
/// EPYC 7763 (AVX2 and FMA)".
fn this_processor() -> &'static str {
    static KIND: OnceLock<String> = OnceLock::new();
    KIND.get_or_init(|| {
        let brand = sysinfo::System::new().ok().and_then(|mut system| {
            system.refresh_cpu_all();
            system.cpus().first().map(|cpu| cpu.brand().trim().to_owned())
        });
        format!("{} ({})", brand.unwrap_or_else(|| "unknown processor".into()), instruction_set())
    })
}

#[cfg(target_arch = "x86_64")]
fn instruction_set() -> &'static str {
    // gemm has kernels for AVX-512, too, but only for nightly compilers.
    if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") { "AVX2 and FMA" } else { "SSE2" }
}

#[cfg(not(target_arch = "x86_64"))]
fn instruction_set() -> &'static str {
    std::env::consts::ARCH
}
