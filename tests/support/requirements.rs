//! Tools that a few tests need beyond Rust. Without them a test is skipped with one line that names the packages; in CI
//! (`CI=true`) a missing tool is a failure.

#![allow(dead_code, reason = "each test file uses part of this module")]

use std::process::{Command, Stdio};

/// The tools that a virtual display with a mouse needs.
pub const DISPLAY: Requirement = Requirement {
    commands: &["Xvfb", "xdotool"],
    packages: "xvfb xdotool mesa-vulkan-drivers libvulkan1 libxkbcommon-x11-0 libxcursor1 libxi6 libxrandr2",
};

/// Commands that must be on the PATH, and the Debian packages that provide them.
pub struct Requirement {
    /// The commands.
    pub commands: &'static [&'static str],
    /// The packages.
    pub packages: &'static str,
}

impl Requirement {
    /// Whether all commands are there. If not, prints why the test is skipped, or fails in CI.
    pub fn is_met(&self) -> bool {
        let missing: Vec<&str> = self.commands.iter().copied().filter(|command| !exists(command)).collect();
        if missing.is_empty() {
            return true;
        }
        report_skip(&format!("{} not found; help: apt-get install {}", missing.join(" and "), self.packages));
        false
    }
}

/// Whether a font with Japanese characters is installed. If not, prints why the test is skipped, or fails in CI.
pub fn japanese_font_is_installed() -> bool {
    let installed = !wayfield::report::fonts::system_fonts_with(&['迷']).is_empty();
    if !installed {
        report_skip("no font with Japanese characters; help: apt-get install fonts-droid-fallback");
    }
    installed
}

/// Prints that a test is skipped and why; fails in CI, where no test may be skipped.
pub fn report_skip(why: &str) {
    let test = std::thread::current().name().unwrap_or("test").to_string();
    assert!(std::env::var_os("CI").is_none(), "{test} must not be skipped in CI: {why}");
    eprintln!("skipped {test}: {why}");
}

fn exists(command: &str) -> bool {
    // Any exit status will do: the tool has started.
    let started = Command::new(command).arg("-version").stdout(Stdio::null()).stderr(Stdio::null()).status();
    started.is_ok()
}
