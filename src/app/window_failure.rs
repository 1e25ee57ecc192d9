//! Failures to open the window, as messages with a fix.
//!
//! In: the app. Out: its result, or a [`RunError`]. winit, Bevy and the libraries that they load at run time panic when the
//! display, the graphics driver or a library is missing. Such a panic on the main thread becomes an error with a message; any
//! other panic remains a panic.

use std::panic::{self, AssertUnwindSafe};
use std::thread;

use crate::run::RunError;

/// Connects to the X display: without one, winit would panic. Keep the connection until the window is open, because a
/// display such as Xvfb restarts when its last client disconnects, and is not available meanwhile.
///
/// # Errors
/// There is no display.
#[cfg(all(unix, not(target_os = "macos")))]
pub fn connect_to_display() -> Result<x11rb::rust_connection::RustConnection, RunError> {
    let is_set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    x11rb::connect(None).map(|(connection, _)| connection).map_err(|error| {
        RunError::InvalidInput(if is_set("WAYLAND_DISPLAY") && !is_set("DISPLAY") {
            "no X11 display for the window, and Wayland alone is not supported; help: install XWayland (Debian, Ubuntu: \
             xwayland), or train without a window with `wayfield --train`"
                .into()
        } else {
            format!(
                "no display for the window ({error}); help: train without a window with `wayfield --train`, or set DISPLAY"
            )
        })
    })
}

/// Runs `app`, and turns a panic that [`explanation`] knows into an error.
///
/// # Errors
/// There is no graphics driver, a library is missing, or no thread can be started.
///
/// # Panics
/// `app` panics for another reason.
pub fn catch<T>(app: impl FnOnce() -> T) -> Result<T, RunError> {
    let default_hook = panic::take_hook();
    let window_thread = thread::current().id();
    panic::set_hook(Box::new(move |info| {
        // The panic of another thread may end that thread alone: then only the hook can report it.
        let is_of_window = thread::current().id() == window_thread;
        if !is_of_window || explanation(info.payload_as_str().unwrap_or_default()).is_none() {
            default_hook(info);
        }
    }));
    panic::catch_unwind(AssertUnwindSafe(app)).map_err(|payload| {
        let text = payload.downcast_ref::<String>().map(String::as_str);
        let text = text.or_else(|| payload.downcast_ref::<&str>().copied());
        explanation(text.unwrap_or_default()).unwrap_or_else(|| panic::resume_unwind(payload))
    })
}

/// The error for a panic of winit, Bevy or a library that they load, if its reason is known.
fn explanation(panic: &str) -> Option<RunError> {
    let without_window = "or train without a window with `wayfield --train`";
    if panic.contains("Unable to find a GPU") || panic.contains("wgpu surface") {
        return Some(RunError::InvalidInput(format!(
            "no graphics driver for the window; help: install one (Debian, Ubuntu: mesa-vulkan-drivers and libvulkan1), \
             {without_window}"
        )));
    }
    if panic.to_lowercase().contains("failed to spawn thread") {
        return Some(RunError::Failed(format!(
            "no thread can be started for the window; help: raise `ulimit -u` or the container's limit on processes, \
             {without_window}"
        )));
    }
    let is_about_library = panic.contains("could not be loaded") || panic.contains("opening library failed");
    let library = panic.split(|c: char| !(c.is_alphanumeric() || "-._+".contains(c)));
    let library =
        library.filter(|_| is_about_library).find(|word| word.starts_with("lib") && word.contains(".so"))?;
    Some(RunError::InvalidInput(format!(
        "the window needs the library {library}; help: install it (Debian, Ubuntu: {}), {without_window}",
        debian_package(library)
    )))
}

/// The name of the Debian package of a shared library: `libX11-xcb.so.1` is in libx11-xcb1.
fn debian_package(library: &str) -> String {
    let (name, version) = library.split_once(".so").unwrap_or((library, ""));
    let version = version.trim_start_matches('.').split('.').next().filter(|version| !version.is_empty());
    let separator = if name.ends_with(|c: char| c.is_ascii_digit()) { "-" } else { "" };
    format!("{}{separator}{}", name.to_lowercase(), version.unwrap_or("0"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_library_is_named_with_its_package() {
        for (panic, package) in [
            ("Library libxkbcommon-x11.so could not be loaded.", "libxkbcommon-x11-0"),
            (
                "detail: \"opening library failed (/lib/x86_64-linux-gnu/libX11-xcb.so.1: file too short)\"",
                "libx11-xcb1",
            ),
            (
                "detail: \"opening library failed (libXcursor.so.1: cannot open shared object file)\"",
                "libxcursor1",
            ),
        ] {
            let error = explanation(panic).expect("known");
            assert_eq!(error.exit_status(), 2);
            assert!(error.to_string().contains(&format!("Ubuntu: {package})")), "{panic}: {error}");
        }
    }

    #[test]
    fn an_unknown_panic_remains_a_panic() {
        assert_eq!(explanation("index out of bounds: the len is 3 but the index is 7"), None);
        let caught = panic::catch_unwind(|| catch(|| panic!("not about the window")));
        assert!(caught.is_err(), "the panic propagates");
    }

    #[test]
    fn only_the_panic_that_ends_the_app_is_explained() {
        let error = catch(|| panic!("Failed to create wgpu surface")).expect_err("the app panics");
        assert!(error.to_string().contains("no graphics driver"), "{error}");
        let app = || {
            let other = thread::spawn(|| panic!("failed to spawn thread")).join();
            assert!(other.is_err(), "the other thread panics");
            panic!("not about the window");
        };
        let caught = panic::catch_unwind(|| catch(app));
        assert!(
            caught.is_err(),
            "the panic propagates, although another thread panicked for a known reason before"
        );
    }
}
