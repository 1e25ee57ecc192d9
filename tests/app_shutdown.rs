//! The end of the real window, by a signal, a lost display or the user: the training run is saved in a folder from which
//! `--resume` continues, stderr names the folder, and the next start offers to continue.
#![cfg(all(feature = "gui", target_os = "linux"))]

#[path = "support/window_process.rs"]
mod window_process;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Output, Stdio};

use tempfile::TempDir;
use window_process::{Controls, Display, command, text, wait_until, xdotool};
use x11rb::connection::Connection;
use x11rb::protocol::xproto::{ClientMessageEvent, ConnectionExt, EventMask};

/// The window, which ends with the test.
struct App {
    process: Option<Child>,
    home: TempDir,
}

impl App {
    /// A window that trains at full pace and saves every `seconds` s. Returns after the first autosave.
    fn training(display: &Display, seconds: &str) -> Self {
        let app = Self::start(display, tempfile::tempdir().expect("temporary folder"), seconds);
        assert!(wait_until(60, || app.autosave().is_some()), "the training is saved");
        app
    }

    fn start(display: &Display, home: TempDir, seconds: &str) -> Self {
        Self::start_with(display, home, &["--pace", "full", "--checkpoint-every", seconds])
    }

    fn start_with(display: &Display, home: TempDir, arguments: &[&str]) -> Self {
        let mut command =
            command(Some(&display.name), home.path(), &[arguments, &["--size", "1280x800"]].concat());
        command.env("WAYFIELD_CONTROLS", home.path().join("controls")).stderr(Stdio::piped());
        Self { process: Some(command.spawn().expect("the binary starts")), home }
    }

    /// The autosave, if there is one.
    fn autosave(&self) -> Option<PathBuf> {
        let folder = self.home.path().join("data/wayfield/autosave/scenario-1-fast-0");
        folder.join("autosave.ron").exists().then_some(folder)
    }

    /// Env steps of the training in the autosave.
    fn saved_env_steps(&self) -> Option<u64> {
        saved_env_steps(&self.autosave()?)
    }

    /// Takes the folder of the app's files, for the next start.
    fn take_home(&mut self) -> TempDir {
        std::mem::replace(&mut self.home, tempfile::tempdir().expect("temporary folder"))
    }

    fn controls(&self) -> Controls {
        Controls(self.home.path().join("controls"))
    }

    fn click(&self, display: &Display, control: &str) {
        let (x, y) = self.controls().centre(control);
        xdotool(display, &format!("mousemove {x} {y}"));
        xdotool(display, "click 1");
    }

    fn signal(&self, signal: &str) {
        let id = self.process.as_ref().expect("it runs").id().to_string();
        let sent = Command::new("kill").args(["-s", signal, &id]).status();
        assert!(sent.is_ok_and(|status| status.success()));
    }

    /// Waits for the end of the process. Returns its exit status and what it printed on stderr.
    fn end(&mut self) -> (ExitStatus, String) {
        let output = self.process.take().expect("it runs").wait_with_output().expect("it ends");
        (output.status, text(&output.stderr))
    }
}

impl Drop for App {
    fn drop(&mut self) {
        if let Some(process) = &mut self.process {
            let _ = process.kill();
            let _ = process.wait();
        }
    }
}

/// Runs the binary without a display.
fn headless(arguments: &[&str]) -> Output {
    let home = tempfile::tempdir().expect("temporary folder");
    command(None, home.path(), arguments).output().expect("the binary starts")
}

/// Env steps of the training in the autosave at `folder`; `None` while the autosave is being replaced.
fn saved_env_steps(folder: &Path) -> Option<u64> {
    let metadata = fs::read_to_string(folder.join("autosave.ron")).ok()?;
    metadata.split("env_steps:").nth(1)?.split(',').next()?.trim().parse().ok()
}

/// Checks that the run in `folder` can be replayed, and that it continues from where the window saved it.
fn assert_resumes(folder: &Path) {
    let target = saved_env_steps(folder).expect("metadata") + 1600;
    let path = folder.to_str().expect("UTF-8");
    let replayed = headless(&["--replay", path]);
    assert!(replayed.status.success(), "{}", text(&replayed.stderr));
    let resumed = headless(&["--resume", path, "--steps", &target.to_string(), "--json"]);
    assert!(resumed.status.success(), "{}", text(&resumed.stderr));
    assert!(text(&resumed.stdout).contains(&format!("\"env_steps\":{target}")), "{}", text(&resumed.stdout));
}

#[test]
fn a_signal_saves_the_training_and_the_exit_status_names_the_signal() {
    let Some(display) = Display::new() else { return };
    for (signal, status) in [("TERM", 143), ("INT", 130), ("HUP", 129)] {
        let mut app = App::training(&display, "2");
        app.signal(signal);
        let (ended, stderr) = app.end();
        assert_eq!(ended.code(), Some(status), "{signal}: {stderr}");
        let folder = app.autosave().expect("the autosave is kept");
        assert!(stderr.contains(folder.to_str().expect("UTF-8")), "stderr says where: {stderr}");
        assert!(stderr.contains("wayfield --resume"), "and how to go on: {stderr}");
        if signal == "TERM" {
            assert_resumes(&folder);
        }
    }
}

#[test]
fn a_lost_display_ends_the_window_and_stderr_says_where_the_autosave_is() {
    let Some(mut display) = Display::new() else { return };
    let mut app = App::training(&display, "0.5");
    display.server.kill().expect("Xvfb ends");
    let (ended, stderr) = app.end();
    assert!(!ended.success(), "{stderr}");
    let folder = app.autosave().expect("the autosave is kept");
    assert!(stderr.contains(folder.to_str().expect("UTF-8")), "stderr says where: {stderr}");
    assert_resumes(&folder);
}

/// Asks the window to close, as a window manager does when the user clicks its close button.
fn request_close(display: &Display) {
    let (connection, screen) = x11rb::connect(Some(&display.name)).expect("the display runs");
    let root = connection.setup().roots[screen].root;
    let atom = |name: &str| {
        let cookie = connection.intern_atom(false, name.as_bytes()).expect("a request");
        cookie.reply().expect("an atom").atom
    };
    let (protocols, delete) = (atom("WM_PROTOCOLS"), atom("WM_DELETE_WINDOW"));
    let windows = connection.query_tree(root).expect("a request").reply().expect("a tree").children;
    for window in windows {
        let event = ClientMessageEvent::new(32, window, protocols, [delete, 0, 0, 0, 0]);
        connection.send_event(false, window, EventMask::NO_EVENT, event).expect("a request");
    }
    // The answer shows that the display has received the events above.
    connection.get_input_focus().expect("a request").reply().expect("an answer");
}

#[test]
fn closing_the_window_asks_and_saves_and_the_next_start_offers_the_session() {
    let Some(display) = Display::new() else { return };
    let mut app = App::training(&display, "1");
    // After 20,000 env steps or a minute, closing needs a confirmation.
    assert!(wait_until(120, || app.saved_env_steps() > Some(20_000)), "it trains");
    request_close(&display);
    app.click(&display, "Cancel");
    assert!(
        app.process.as_mut().expect("it runs").try_wait().is_ok_and(|ended| ended.is_none()),
        "it goes on"
    );
    request_close(&display);
    app.click(&display, "Save run and quit");
    let (ended, stderr) = app.end();
    assert!(ended.success(), "{stderr}");
    let run = app.home.path().join("runs/scenario-1-fast-0");
    assert!(stderr.contains(run.to_str().expect("UTF-8")), "stderr says where: {stderr}");
    let replayed = headless(&["--replay", run.to_str().expect("UTF-8")]);
    assert!(replayed.status.success(), "{}", text(&replayed.stderr));

    let mut next = App::start(&display, app.take_home(), "1000");
    let saved = next.saved_env_steps();
    next.click(&display, "Continue");
    let shown = || fs::read_to_string(next.home.path().join("controls")).unwrap_or_default();
    assert!(wait_until(20, || !shown().contains("Not now")), "the offer is gone: {}", shown());
    next.signal("TERM");
    next.end();
    assert!(next.saved_env_steps() > saved, "the session has continued in its autosave");
}

#[test]
fn the_session_of_a_killed_window_is_offered_at_the_next_start() {
    let Some(display) = Display::new() else { return };
    let mut app = App::training(&display, "0.5");
    app.signal("KILL");
    app.end();
    let next = App::start(&display, app.take_home(), "1000");
    next.controls().centre("Continue");
}

#[test]
fn a_signal_saves_what_is_unsaved_in_the_editor_and_the_next_start_restores_it() {
    let Some(display) = Display::new() else { return };
    let arguments = ["--scenario", "empty", "--edit"];
    let mut app = App::start_with(&display, tempfile::tempdir().expect("temporary folder"), &arguments);
    app.click(&display, "Add a circle");
    app.controls().centre("Obstacle 1");
    app.signal("TERM");
    let (ended, stderr) = app.end();
    assert_eq!(ended.code(), Some(143), "{stderr}");
    let file = app.home.path().join("data/wayfield/autosave/editor/1.ron");
    assert!(stderr.contains(file.to_str().expect("UTF-8")), "stderr says where: {stderr}");
    let mut next = App::start(&display, app.take_home(), "1000");
    next.click(&display, "Restore");
    next.controls().centre("Obstacle 1");
    next.signal("TERM");
    next.end();
}
