//! Snapshots of error messages, in `tests/snapshots/messages/`, where their wording can be reviewed in one place.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use super::Workspace;

/// The error messages of a test, in order.
pub struct Messages {
    name: &'static str,
    text: String,
}

impl Messages {
    /// An empty list of messages for the snapshot `name`.
    pub fn new(name: &'static str) -> Self {
        Self { name, text: String::new() }
    }

    /// Adds a comment that describes the next command's situation.
    pub fn case(&mut self, comment: &str) {
        let _ = writeln!(self.text, "# {comment}");
    }

    /// Adds the message for `arguments`, which must be rejected.
    pub fn add(&mut self, workspace: &Workspace, arguments: &str) {
        let _ = writeln!(self.text, "$ wayfield {arguments}\n{}", rejection(workspace, arguments));
    }

    /// Adds the message for `arguments`, which must be rejected with a message of one line.
    pub fn line(&mut self, workspace: &Workspace, arguments: &str) {
        let message = rejection(workspace, arguments);
        assert_eq!(message.lines().count(), 1, "wayfield {arguments}\n{message}");
        let _ = writeln!(self.text, "$ wayfield {arguments}\n{message}");
    }

    /// Adds all that `wayfield --check file` prints about an invalid `file`.
    pub fn checked(&mut self, workspace: &Workspace, file: &str) {
        let done = workspace.run(&format!("--check {file}"));
        assert_eq!((done.status, done.stdout.as_str()), (Some(2), ""), "{}", done.stderr);
        assert!(!done.stderr.contains("panicked"), "{}", done.stderr);
        let _ = writeln!(self.text, "$ wayfield --check {file}\n{}", done.stderr);
    }

    /// Compares the messages with the snapshot, or renews it if `WAYFIELD_RENEW` is set.
    pub fn check(self) {
        if !cfg!(feature = "gui") {
            // Without the app, messages that list the modes differ.
            return;
        }
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/snapshots/messages");
        let path = folder.join(format!("{}.txt", self.name));
        if std::env::var_os("WAYFIELD_RENEW").is_some() {
            fs::create_dir_all(&folder).unwrap();
            fs::write(&path, self.text).unwrap();
            return;
        }
        let snapshot = fs::read_to_string(&path).unwrap_or_default();
        let path = path.display();
        let help = "help: cargo xtask messages";
        for (line, (found, expected)) in self.text.lines().zip(snapshot.lines()).enumerate() {
            assert_eq!(found, expected, "{path}:{} differs; {help}", line + 1);
        }
        assert_eq!(self.text.len(), snapshot.len(), "{path} is incomplete or too long; {help}");
    }
}

/// Asserts that `arguments` are rejected with exit status 2, one message, nothing on stdout and no change on
/// disk. Returns the message.
pub fn rejection(workspace: &Workspace, arguments: &str) -> String {
    let before = workspace.all_files();
    let done = workspace.run(arguments);
    let output = format!("wayfield {arguments}\n{}", done.stderr);
    assert_eq!(done.status, Some(2), "{output}");
    assert_eq!(done.stdout, "", "{output}");
    assert!(done.stderr.starts_with("error: "), "{output}");
    assert_eq!(done.stderr.matches("error: ").count(), 1, "one message: {output}");
    assert!(!done.stderr.contains("panicked") && !done.stderr.contains("RUST_BACKTRACE"), "{output}");
    let after = workspace.all_files();
    let changed: Vec<_> =
        after.keys().chain(before.keys()).filter(|&k| before.get(k) != after.get(k)).collect();
    assert!(changed.is_empty(), "{output}created or changed: {changed:?}");
    done.stderr
}
