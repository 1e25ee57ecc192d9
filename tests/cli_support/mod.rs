//! Support for the tests of the command line: a temporary workspace, the binary, small presets and scenarios.
//!
//! The binary runs as a user runs it: arguments in; stdout, stderr, exit status and files out.

#![allow(dead_code, reason = "each program uses part of this module")]

#[path = "../support/default_signals.rs"]
mod default_signals;
pub mod event_files;
pub mod messages;

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use default_signals::with_default_signals;
use serde_json::Value;
use tempfile::TempDir;

/// A temporary folder in which the binary runs. It is deleted on drop.
pub struct Workspace {
    folder: TempDir,
}

/// The result of a command.
#[derive(Debug)]
pub struct CommandOutput {
    pub status: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

impl Workspace {
    pub fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn write(&self, name: &str, contents: impl AsRef<[u8]>) {
        fs::write(self.path(name), contents).unwrap();
    }

    pub fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    pub fn text(&self, name: &str) -> String {
        String::from_utf8(self.read(name)).unwrap()
    }

    pub fn json(&self, name: &str) -> Value {
        serde_json::from_str(&self.text(name)).unwrap()
    }

    /// The command for the binary with `arguments`, which are separated by spaces.
    fn command(&self, arguments: &str) -> Command {
        self.command_of_words(arguments.split_whitespace())
    }

    fn command_of_words(&self, words: impl IntoIterator<Item = impl AsRef<OsStr>>) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_wayfield"));
        // No window must open while tests run.
        command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY");
        command.args(words).current_dir(self.folder.path()).stdin(Stdio::null());
        command
    }

    /// Runs the binary with `words`, which may contain spaces or bytes that are not UTF-8.
    pub fn run_words(&self, words: impl IntoIterator<Item = impl AsRef<OsStr>>) -> CommandOutput {
        CommandOutput::new(self.command_of_words(words).output().unwrap())
    }

    /// Runs the binary with `input` in a pipe on its standard input.
    pub fn run_with_stdin(&self, arguments: &str, input: &str) -> CommandOutput {
        let mut command = self.command(arguments);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        child.stdin.take().unwrap().write_all(input.as_bytes()).unwrap();
        wait_for_output(child)
    }

    /// Runs the binary and waits until it exits.
    pub fn run(&self, arguments: &str) -> CommandOutput {
        CommandOutput::new(self.command(arguments).output().unwrap())
    }

    /// Runs the binary with `WAYFIELD_ABORT_AT` set to `write_point`.
    pub fn run_until(&self, arguments: &str, write_point: &str) -> CommandOutput {
        let output = self.command(arguments).env("WAYFIELD_ABORT_AT", write_point).output();
        CommandOutput::new(output.unwrap())
    }

    /// Runs `command` in the workspace, with the path of the binary in `WAYFIELD`, and waits until it exits.
    pub fn finish(&self, mut command: Command) -> CommandOutput {
        command.env("WAYFIELD", env!("CARGO_BIN_EXE_wayfield")).current_dir(self.folder.path());
        CommandOutput::new(command.stdin(Stdio::null()).output().unwrap())
    }

    /// Runs a shell script in the workspace, with the path of the binary in `WAYFIELD`.
    pub fn shell(&self, script: &str) -> CommandOutput {
        let mut command = Command::new("sh");
        command.args(["-euc", script]);
        self.finish(command)
    }

    /// Runs the binary, which must succeed.
    pub fn run_ok(&self, arguments: &str) -> CommandOutput {
        let done = self.run(arguments);
        assert_eq!(done.status, Some(0), "wayfield {arguments}\n{}", done.stderr);
        done
    }

    /// Runs the binary, which must succeed, on the first core that this process may use.
    #[cfg(target_os = "linux")]
    pub fn run_on_one_core(&self, arguments: &str) {
        let status = fs::read_to_string("/proc/self/status").unwrap();
        let allowed = status.lines().find_map(|line| line.strip_prefix("Cpus_allowed_list:")).unwrap().trim();
        let core = allowed.split([',', '-']).next().unwrap();
        let mut pinned = Command::new("taskset");
        pinned.args(["-c", core, env!("CARGO_BIN_EXE_wayfield")]).args(arguments.split_whitespace());
        let done = self.finish(pinned);
        assert_eq!(done.status, Some(0), "{}", done.stderr);
    }

    /// Starts the binary. [`wait_for_output`] collects its output.
    pub fn start(&self, arguments: &str) -> Child {
        let binary = self.command(arguments);
        let mut command = with_default_signals(binary.get_program());
        command.args(binary.get_args()).env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY");
        command
            .current_dir(self.folder.path())
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap()
    }

    /// Starts a `sh` script, which has the path of the binary in `WAYFIELD`.
    pub fn start_shell(&self, script: &str) -> Child {
        let mut shell = with_default_signals("sh");
        shell.args(["-euc", script]).env("WAYFIELD", env!("CARGO_BIN_EXE_wayfield"));
        shell.current_dir(self.folder.path()).stdin(Stdio::piped());
        shell.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
    }

    /// Every file in the workspace with its contents, and every folder with `None`.
    pub fn all_files(&self) -> BTreeMap<PathBuf, Option<Vec<u8>>> {
        fn walk(folder: &Path, files: &mut BTreeMap<PathBuf, Option<Vec<u8>>>) {
            for entry in fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    walk(&path, files);
                    files.insert(path, None);
                } else {
                    let bytes = fs::read(&path).unwrap();
                    files.insert(path, Some(bytes));
                }
            }
        }
        let mut files = BTreeMap::new();
        walk(self.folder.path(), &mut files);
        files
    }

    /// The rows of a CSV file, without the column `wall_s`.
    pub fn rows(&self, name: &str) -> Vec<BTreeMap<String, String>> {
        let mut reader = csv::Reader::from_path(self.path(name)).unwrap();
        let rows: Vec<BTreeMap<String, String>> = reader.deserialize().map(Result::unwrap).collect();
        rows.into_iter()
            .map(|mut row| {
                assert!(row.remove("wall_s").is_some(), "{name} has no column wall_s");
                row
            })
            .collect()
    }

    /// The lines of a CSV file without the column `wall_s`.
    fn lines_without_wall_time(&self, name: &str) -> Vec<String> {
        let text = self.text(name);
        let head = text.lines().next().unwrap_or_default();
        let wall = head.split(',').position(|column| column == "wall_s").expect("a column wall_s");
        let without = |line: &str| {
            let cells = line.split(',').enumerate().filter(|(column, _)| *column != wall);
            cells.map(|(_, cell)| cell).collect::<Vec<_>>().join(",")
        };
        text.lines().map(without).collect()
    }

    /// All contents of a run folder that must be equal in two runs with the same seed.
    pub fn run_contents(&self, run: &str) -> RunContents {
        let mut summary = self.json(&format!("{run}/summary.json"));
        remove_wall_time(&mut summary);
        RunContents {
            best: self.read(&format!("{run}/policy.safetensors")),
            last: self.read(&format!("{run}/policy-last.safetensors")),
            episodes: self.lines_without_wall_time(&format!("{run}/episodes.csv")),
            evaluations: self.lines_without_wall_time(&format!("{run}/evaluations.csv")),
            config: self.text(&format!("{run}/config.ron")),
            curves: event_files::curves(&self.path(run)),
            summary,
        }
    }

    /// Asserts that two runs are equal. The message names the first difference.
    pub fn assert_same_run(&self, one: &str, other: &str) {
        let (a, b) = (self.run_contents(one), self.run_contents(other));
        for (name, a, b) in
            [("episodes.csv", &a.episodes, &b.episodes), ("evaluations.csv", &a.evaluations, &b.evaluations)]
        {
            assert!(a.len() > 1, "{one}/{name} has no rows");
            for (number, (a, b)) in a.iter().zip(b).enumerate() {
                assert_eq!(a, b, "{name} of {one} and {other} differ in line {}", number + 1);
            }
            assert_eq!(a.len(), b.len(), "{name} of {one} and {other} differ in length");
        }
        for (tag, points) in &a.curves {
            assert_eq!(
                Some(points),
                b.curves.get(tag),
                "TensorBoard's curves {tag} of {one} and {other} differ"
            );
        }
        assert_eq!(a.curves.len(), b.curves.len(), "{other} has more curves than {one}");
        assert_eq!(a.config, b.config, "config.ron of {one} and {other} differ");
        assert_eq!(a.summary, b.summary, "summary.json of {one} and {other} differ");
        assert!(a.last == b.last, "policy-last.safetensors of {one} and {other} differ");
        assert!(a.best == b.best, "policy.safetensors of {one} and {other} differ");
    }
}

/// The contents of a run folder without wall times.
#[derive(Debug, PartialEq)]
pub struct RunContents {
    pub best: Vec<u8>,
    pub last: Vec<u8>,
    pub episodes: Vec<String>,
    pub evaluations: Vec<String>,
    pub config: String,
    pub curves: event_files::Curves,
    pub summary: Value,
}

fn remove_wall_time(value: &mut Value) {
    if let Value::Object(fields) = value {
        fields.remove("wall_s");
        fields.values_mut().for_each(remove_wall_time);
    }
}

impl CommandOutput {
    fn new(output: std::process::Output) -> Self {
        Self {
            status: output.status.code(),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }

    /// Stdout, which must be one JSON object.
    pub fn json(&self) -> Value {
        let value: Value = serde_json::from_str(&self.stdout)
            .unwrap_or_else(|error| panic!("stdout is not one JSON value ({error}): {}", self.stdout));
        assert!(value.is_object(), "{value}");
        value
    }
}

/// Waits until a started command exits.
pub fn wait_for_output(child: Child) -> CommandOutput {
    CommandOutput::new(child.wait_with_output().unwrap())
}

/// Waits until `holds` returns true. Kills the child and panics if this takes more than a minute or the child
/// exits first.
pub fn wait_until(child: &mut Child, what: &str, holds: impl Fn() -> bool) {
    let began = Instant::now();
    loop {
        // Check for the exit before `holds`: the last thing that the child does may be what this waits for.
        let is_over = began.elapsed() > Duration::from_secs(60) || child.try_wait().unwrap().is_some();
        if holds() {
            return;
        }
        if is_over {
            let _ = child.kill();
            panic!("did not happen: {what}");
        }
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// Sends the signal `name` (such as `INT` or `KILL`).
pub fn signal(child: &Child, name: &str) {
    let status = Command::new("kill").arg(format!("-{name}")).arg(child.id().to_string()).status().unwrap();
    assert!(status.success());
}

/// `text` with replacements, each of which must match exactly once.
pub fn edited(text: &str, replacements: &[(&str, &str)]) -> String {
    replacements.iter().fold(text.to_owned(), |text, (from, to)| {
        assert_eq!(text.matches(from).count(), 1, "`{from}` in {text}");
        text.replace(from, to)
    })
}

pub const FAST: &str = include_str!("../../assets/presets/fast.ron");
pub const PER_D3QN: &str = include_str!("../../assets/presets/per_d3qn.ron");
pub const SCENARIO_1: &str = include_str!("../../scenarios/scenario-1.ron");
pub const SCENARIO_2: &str = include_str!("../../scenarios/scenario-2.ron");

/// The paper's algorithm in one arena (prioritized replay, RMSProp, hard target updates, epsilon by
/// episodes), made fast: a small network, a replay buffer that wraps around many times, and frequent short
/// evaluations.
pub fn quick_per() -> String {
    edited(
        PER_D3QN,
        &[
            (
                "every_env_steps: 20000, episodes: 200",
                "every_env_steps: 1500, episodes: 20, final_episodes: 20",
            ),
            ("hidden: [64, 64]", "hidden: [16]"),
            ("batch_size: 64", "batch_size: 16"),
            ("capacity: 1000000", "capacity: 2000"),
            ("every: 2000", "every: 100"),
        ],
    )
}

/// The default preset in 16 arenas (2-step returns, Adam, Huber loss, soft target updates, schedules by env
/// steps), made fast.
pub fn quick_fast() -> String {
    edited(
        FAST,
        &[
            (
                "every_env_steps: 5000, episodes: 200",
                "every_env_steps: 1500, episodes: 20, final_episodes: 20",
            ),
            ("hidden: [64, 64]", "hidden: [16]"),
            ("batch_size: 64", "batch_size: 32"),
            ("capacity: 400000", "capacity: 3000"),
        ],
    )
}

/// `preset` with raw observations: eq. (8) in m and rad.
pub fn raw(preset: &str) -> String {
    edited(preset, &[("    reward: (", "    observation: Raw,\n    reward: (")])
}

/// `scenario` with shorter episodes.
pub fn with_short_episodes(scenario: &str) -> String {
    edited(scenario, &[("    obstacles: [", "    task: (max_episode_steps: 120),\n\n    obstacles: [")])
}

/// `scenario` with shorter episodes and a noisy LIDAR.
pub fn noisy(scenario: &str) -> String {
    edited(
        &with_short_episodes(scenario),
        &[("    obstacles: [", "    lidar: (noise_std_m: 0.02, dropout: 0.05),\n\n    obstacles: [")],
    )
}
