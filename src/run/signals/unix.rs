//! Signal handlers on Unix.

use std::io;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};
use signal_hook::consts::signal::{SIGABRT, SIGHUP, SIGINT, SIGTERM, SIGUSR1, SIGUSR2, SIGXCPU, SIGXFSZ};
use signal_hook::flag;
use signal_hook::iterator::SignalsInfo;
use signal_hook::iterator::exfiltrator::origin::WithOrigin;
use signal_hook::low_level::siginfo::Origin;
use signal_hook::low_level::signal_name;

use super::{FIRST, STOP, StopSignal};
use crate::run::progress::print_stderr;

/// The signals that ask the program to stop. SLURM and Grid Engine can be configured to send SIGUSR1 or SIGUSR2 before they
/// kill a job; the kernel sends SIGXCPU at the soft limit of CPU time (`ulimit -S -t`).
const STOP_SIGNALS: [i32; 6] = [SIGINT, SIGTERM, SIGHUP, SIGXCPU, SIGUSR1, SIGUSR2];
/// A Ctrl-C in the terminal ends the process at once if it comes at least this long after the first signal.
const SECOND_CTRL_C: Duration = Duration::from_millis(500);

/// The condition for handlers that always act.
static ALWAYS: AtomicBool = AtomicBool::new(true);
/// The number of the last signal; 0 before the first.
static LAST: AtomicUsize = AtomicUsize::new(0);

/// Makes the limits of the process cause errors instead of signals: a write beyond the limit of file sizes (`ulimit -f`) fails,
/// and an abort after a failed allocation, at a memory limit (`ulimit -v`, `ulimit -d`), becomes exit status 1.
pub fn survive_limits() {
    static SEEN: AtomicBool = AtomicBool::new(false);
    // If a handler cannot be installed, the limit will kill the process. That is no reason to stop now.
    if !is_ignored(SIGXFSZ) {
        let _ = flag::register(SIGXFSZ, &SEEN);
    }
    if [Resource::As, Resource::Data].into_iter().any(|memory| getrlimit(memory).current.is_some()) {
        let _ = flag::register_conditional_shutdown(SIGABRT, 1, &ALWAYS);
    }
}

/// Makes the first signal end the process with its [exit status](super::StopSignal::exit_status), for work that leaves nothing
/// to save. (Without a handler, the first process of a container would not notice the signal.)
pub fn exit_on_signal() {
    for signal in stop_signals() {
        // Without the handler, the signal kills the process.
        let _ = flag::register_conditional_shutdown(signal, 128 + signal, &ALWAYS);
    }
}

/// The signals in [`STOP_SIGNALS`] that are not ignored.
fn stop_signals() -> Vec<i32> {
    STOP_SIGNALS.into_iter().filter(|signal| !is_ignored(*signal)).collect()
}

/// Installs the handlers of [`stop_signals`].
pub fn stop_on_signal(announcement: &'static str) -> io::Result<()> {
    let signals = stop_signals();
    for &signal in &signals {
        flag::register_usize(signal, &LAST, signal as usize)?;
        flag::register(signal, &STOP)?;
    }
    let signals = SignalsInfo::<WithOrigin>::new(&signals)?;
    lower_soft_cpu_limit();
    // Without the thread, there is no announcement, and a second Ctrl-C does nothing, but the run still stops and saves.
    let _ = thread::Builder::new().name("signals".into()).spawn(move || watch(signals, announcement));
    Ok(())
}

/// Lowers the soft limit of CPU time (`ulimit -t`) below the hard one, at which the kernel kills the process without notice.
/// The soft limit sends SIGXCPU, and leaves time to save.
fn lower_soft_cpu_limit() {
    let limit = getrlimit(Resource::Cpu);
    let Some(hard_s) = limit.maximum else { return };
    let early_s = hard_s.saturating_sub((hard_s / 4).clamp(1, 10));
    if limit.current.is_none_or(|soft_s| soft_s > early_s) {
        // The limit can always be lowered.
        let _ = setrlimit(Resource::Cpu, Rlimit { current: Some(early_s), maximum: Some(hard_s) });
    }
}

/// The name of a signal, such as `SIGTERM`.
pub fn name(signal: u8) -> &'static str {
    match i32::from(signal) {
        SIGXCPU => "SIGXCPU (the limit of CPU time)",
        signal => signal_name(signal).unwrap_or("a signal"),
    }
}

/// The number of the last signal; 0 before the first.
pub fn last_signal() -> usize {
    LAST.load(Ordering::SeqCst)
}

/// Records and announces the first signal; ends the process at a later Ctrl-C in the terminal.
fn watch(mut signals: SignalsInfo<WithOrigin>, announcement: &str) {
    let mut first_at: Option<Instant> = None;
    loop {
        let received: Vec<Origin> = signals.wait().collect();
        // The kernel delivers signals that arrive together in the order of their numbers.
        let Some(first) = received.iter().map(|origin| origin.signal).min() else { continue };
        match first_at {
            None => {
                first_at = Some(Instant::now());
                FIRST.store(first as usize, Ordering::SeqCst);
                print_stderr(&format!("{}: {announcement}", StopSignal(first as u8).name()));
            }
            Some(at) if at.elapsed() >= SECOND_CTRL_C && received.iter().any(is_from_terminal) => {
                std::process::exit(128 + FIRST.load(Ordering::SeqCst) as i32);
            }
            Some(_) => {}
        }
    }
}

/// Whether the signal is a Ctrl-C. A terminal's signal comes from the kernel, so it has no sender.
fn is_from_terminal(origin: &Origin) -> bool {
    origin.signal == SIGINT && origin.process.is_none()
}

/// Whether this process ignores `signal`, as it does if the program that started it did. `false` if this is unknown, because the
/// system has no `/proc`.
fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0);
    mask >> (signal - 1) & 1 == 1
}
