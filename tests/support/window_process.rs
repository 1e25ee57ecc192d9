//! The binary with its window, on a virtual display (Xvfb) with Mesa's software GPU, and the user's actions in it.
#![allow(dead_code, reason = "each test file uses part of this module")]

#[path = "default_signals.rs"]
mod default_signals;
#[path = "requirements.rs"]
pub mod requirements;

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use default_signals::with_default_signals;

/// A virtual display, which ends with the test.
pub struct Display {
    pub server: Child,
    pub name: String,
}

impl Display {
    /// A display of 1280 x 800 pixels. `None` if the tools for it are missing; then the test is skipped.
    pub fn new() -> Option<Self> {
        Self::with_size("1280x800")
    }

    /// Like [`Self::new`], with this size in pixels.
    pub fn with_size(size: &str) -> Option<Self> {
        if !requirements::DISPLAY.is_met() {
            return None;
        }
        let mut server = Command::new("Xvfb")
            .args(["-displayfd", "1", "-screen", "0", &format!("{size}x24"), "-nolisten", "tcp"])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("Xvfb starts");
        let mut number = String::new();
        let from = server.stdout.take().expect("stdout is piped");
        BufReader::new(from).read_line(&mut number).expect("Xvfb prints the number of its display");
        assert!(!number.trim().is_empty(), "Xvfb found no free display number");
        Some(Self { server, name: format!(":{}", number.trim()) })
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// The binary, with its working directory, settings and data in `home`.
pub fn command(display: Option<&str>, home: &Path, arguments: &[&str]) -> Command {
    let mut command = with_default_signals(env!("CARGO_BIN_EXE_wayfield"));
    command.args(arguments).current_dir(home).env("XDG_CONFIG_HOME", home).env("XDG_RUNTIME_DIR", home);
    command.env("XDG_DATA_HOME", home.join("data"));
    command.env_remove("WAYLAND_DISPLAY").env_remove("DISPLAY");
    if let Some(display) = display {
        command.env("DISPLAY", display);
    }
    command
}

/// Waits until `done`, for at most `seconds`. Returns whether it is done.
pub fn wait_until(seconds: u64, done: impl Fn() -> bool) -> bool {
    let started = std::time::Instant::now();
    while !done() && started.elapsed().as_secs() < seconds {
        std::thread::sleep(std::time::Duration::from_millis(100));
    }
    done()
}

/// The text of an output.
pub fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// The named controls of a running app, which it writes to a file.
pub struct Controls(pub PathBuf);

impl Controls {
    /// The centre of the control or item with this accessible name, in points. Waits until it is displayed and at rest.
    pub fn centre(&self, name: &str) -> (f64, f64) {
        let found = || self.rect(name).map(|[x, y, width, height]| (x + width / 2.0, y + height / 2.0));
        let mut last = None;
        for _ in 0..100 {
            let now = found();
            match now {
                Some(at) if now == last => return at,
                _ => last = now,
            }
            std::thread::sleep(PAUSE);
        }
        panic!("no control `{name}` at rest; last: {:?}", std::fs::read_to_string(&self.0));
    }

    /// Left, top, width and height of the control, in points.
    pub fn rect(&self, name: &str) -> Option<[f64; 4]> {
        let text = std::fs::read_to_string(&self.0).ok()?;
        let line = text.lines().find(|line| line.split('\t').nth(4) == Some(name))?;
        let mut numbers = line.split('\t').map(|number| number.parse().expect("a number"));
        Some(std::array::from_fn(|_| numbers.next().expect("four numbers")))
    }
}

/// Simulates mouse input with `xdotool`.
pub fn xdotool(display: &Display, action: &str) {
    let done = Command::new("xdotool").args(action.split(' ')).env("DISPLAY", &display.name).status();
    assert!(done.expect("xdotool starts").success(), "{action}");
    std::thread::sleep(PAUSE);
}

/// A software GPU draws about ten frames per second; at least one should follow each action.
const PAUSE: Duration = Duration::from_millis(400);
