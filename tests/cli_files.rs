//! Tests of files that users name: pipes, devices, links, and names that need quoting or are not UTF-8. Neither the name nor the
//! text of a file may control a terminal.

mod cli_support;

use std::ffi::OsStr;
use std::fs;
use std::time::{Duration, Instant};

use cli_support::{CommandOutput, FAST, Workspace, quick_fast};
use wayfield::policy::Policy;

const MINE: &str = "(name: \"Mine\")";
const IMAGE: &str = "--draw map.svg --scenario";

/// Asserts that the command was refused with a message about the input.
fn assert_refused(done: &CommandOutput, message: &str) {
    assert_eq!(done.status, Some(2), "{}", done.stderr);
    assert!(done.stderr.contains(message), "{message}\nis not in\n{}", done.stderr);
    assert!(!done.stderr.contains("panicked"), "{}", done.stderr);
}

/// Asserts that nothing in the output acts on a terminal.
fn assert_harmless(done: &CommandOutput) {
    let output = format!("{}{}", done.stdout, done.stderr);
    let is_harmful = |c: char| (c.is_control() && c != '\n' && c != '\t') || "\u{202e}\u{2066}".contains(c);
    assert!(!output.contains(is_harmful), "{output:?}");
}

#[test]
fn standard_input_is_read_once_and_may_be_a_pipe() {
    let workspace = Workspace::new();
    workspace.write("quick.ron", quick_fast());
    let names: &[&str] = if cfg!(unix) { &["-", "/dev/stdin"] } else { &["-"] };
    for name in names {
        let done = workspace.run_with_stdin(&format!("--check {name}"), MINE);
        assert_eq!(
            (done.stdout, done.status),
            (format!("{name}: ok (scenario)\n"), Some(0)),
            "{}",
            done.stderr
        );
        let done = workspace.run_with_stdin(&format!("--check {name} {name}"), FAST);
        assert_eq!(done.stdout, format!("{name}: ok (preset)\n").repeat(2), "{}", done.stderr);
        assert_refused(
            &workspace.run_with_stdin(&format!("--check {name}"), "(name: 3)"),
            ":1:8: `name` must be text",
        );
        let out = format!("run{}", name.len());
        let train = format!("--train --preset quick.ron --scenario {name} --steps 16 --out {out}");
        assert_eq!(workspace.run_with_stdin(&train, MINE).status, Some(0));
        assert!(workspace.text(&format!("{out}/config.ron")).contains("name: \"Mine\""));
    }
    let done = workspace.run_with_stdin("--train --preset - --steps 16", &quick_fast());
    assert_eq!(done.status, Some(0), "{}", done.stderr);
    assert!(workspace.path("runs/scenario-1-stdin-0").is_dir(), "the folder's name can be typed");
    if cfg!(unix) {
        let done = workspace.run_with_stdin("--check - /dev/stdin", FAST);
        assert_eq!(done.stdout, "-: ok (preset)\n/dev/stdin: ok (preset)\n", "{}", done.stderr);
    }
    assert_refused(&workspace.run("--check -"), "-: the file is empty");
}

#[cfg(unix)]
mod unix {
    use std::ffi::OsString;
    use std::os::unix::ffi::OsStringExt;
    use std::os::unix::fs::symlink;
    use std::os::unix::net::UnixListener;
    use std::process::Command;

    use super::*;

    fn mkfifo(workspace: &Workspace, name: &str) {
        let status = Command::new("mkfifo").arg(workspace.path(name)).status().expect("mkfifo is there");
        assert!(status.success());
    }

    #[test]
    fn a_named_pipe_that_nobody_writes_to_is_refused_at_once() {
        let workspace = Workspace::new();
        fs::create_dir(workspace.path("d")).unwrap();
        mkfifo(&workspace, "d/a.ron");
        let refused_in_time = |arguments: &str, message: &str| {
            let began = Instant::now();
            assert_refused(&workspace.run(arguments), message);
            assert!(began.elapsed() < Duration::from_secs(10), "{arguments}: {:?}", began.elapsed());
        };
        let message = "it is a named pipe that no program writes to";
        for command in
            ["--check", "--eval", IMAGE, "--train --scenario", "--train --preset", "--train --init"]
        {
            refused_in_time(&format!("{command} d/a.ron"), message);
        }
        refused_in_time("--reproduce --experiment d/a.ron", message);
        refused_in_time(
            "--check d",
            "d/a.ron: this is a pipe, a socket or a device, not a file; help: remove it",
        );
        assert!(!workspace.path("runs").exists() && !workspace.path("map.svg").exists());
    }

    #[test]
    fn a_named_pipe_is_read_as_soon_as_a_program_writes_to_it() {
        let workspace = Workspace::new();
        mkfifo(&workspace, "pipe");
        let pipe = workspace.path("pipe");
        let writer = std::thread::spawn(move || fs::write(pipe, MINE));
        workspace.run_ok("--draw map.svg --scenario pipe");
        writer.join().unwrap().unwrap();
        assert!(workspace.text("map.svg").starts_with("<svg"));
        // A policy, and an experiment, which are read in other ways.
        workspace.run_ok("--train --steps 16 --out run");
        let (pipe, policy) = (workspace.path("pipe"), workspace.read("run/policy.safetensors"));
        let writer = std::thread::spawn(move || fs::write(pipe, policy));
        workspace.run_ok("--eval pipe --rounds 1 --episodes 1");
        writer.join().unwrap().unwrap();
        let (pipe, fig8) = (workspace.path("pipe"), include_str!("../assets/experiments/fig8.ron"));
        let writer = std::thread::spawn(move || fs::write(pipe, fig8));
        assert_eq!(workspace.run_ok("--check pipe").stdout, "pipe: ok (experiment)\n");
        writer.join().unwrap().unwrap();
    }

    #[test]
    fn devices_sockets_links_and_folders_are_told_apart() {
        let workspace = Workspace::new();
        let _socket = UnixListener::bind(workspace.path("socket.ron")).unwrap();
        fs::create_dir(workspace.path("folder.ron")).unwrap();
        symlink("gone.ron", workspace.path("dangling.ron")).unwrap();
        symlink("loop.ron", workspace.path("loop.ron")).unwrap();
        workspace.write("mine.ron", MINE);
        symlink("mine.ron", workspace.path("link.ron")).unwrap();
        for (name, message) in [
            ("/dev/null", "/dev/null: the file is empty"),
            ("/dev/zero", "/dev/zero: larger than 1 MiB"),
            ("socket.ron", "socket.ron: can't be read: it is a socket, not a file"),
            ("folder.ron", "folder.ron: this is a folder: name a file in it"),
            ("dangling.ron", "dangling.ron: this link points to `gone.ron`, which does not exist"),
            ("loop.ron", "loop.ron: can't be read: "),
        ] {
            assert_refused(&workspace.run(&format!("{IMAGE} {name}")), message);
        }
        assert_eq!(workspace.run_ok("--check link.ron").stdout, "link.ron: ok (scenario)\n");
        if cfg!(target_os = "linux") {
            // Its length is 0, but it has content.
            assert_refused(
                &workspace.run("--check /proc/version"),
                "/proc/version:1:1: expected `Scenario(...)`",
            );
        }
    }

    #[test]
    fn a_name_that_is_not_utf8_works_or_the_argument_is_named() {
        let workspace = Workspace::new();
        let file = OsString::from_vec(b"w\xff.ron".to_vec());
        fs::write(workspace.path("").join(&file), MINE).unwrap();
        let run =
            |words: &[&str], last: &OsStr| workspace.run_words(words.iter().map(OsStr::new).chain([last]));
        let done = run(&["--check"], &file);
        assert_eq!((done.stdout.as_str(), done.status), ("w\u{fffd}.ron: ok (scenario)\n", Some(0)));
        for flag in ["--scenario", "--preset"] {
            let done = run(&["--train", "--steps", "16", flag], &file);
            assert_refused(
                &done,
                &format!("the value 'w\u{fffd}.ron' for '{flag} <FILE>' is not valid UTF-8"),
            );
        }
        let joined = OsString::from_vec(b"--scenario=w\xff.ron".to_vec());
        let done = run(&["--train", "--steps", "16"], &joined);
        assert_refused(&done, "the value 'w\u{fffd}.ron' for '--scenario <FILE>' is not valid UTF-8");
        let done = run(&["--train", "--seed"], &file);
        assert_refused(&done, "for '--seed <N>' is not valid UTF-8");
        let out = OsString::from_vec(b"o\xff".to_vec());
        let done = run(&["--train", "--steps", "16", "--out"], &out);
        assert_eq!(done.status, Some(0), "{}", done.stderr);
        assert!(workspace.path("").join(&out).join("summary.json").exists());
    }

    /// The command that a training run's summary gives for testing the policy, limited to one episode.
    fn printed_command(summary: &str) -> String {
        let line = summary
            .lines()
            .find_map(|line| line.strip_prefix("test it"))
            .expect("the summary names a command");
        format!("{} --rounds 1 --episodes 1", line.trim())
    }

    #[test]
    fn the_printed_command_can_be_pasted_into_a_shell() {
        let workspace = Workspace::new();
        let folder = OsString::from_vec(b"d'\xff $HOME".to_vec());
        let folder = workspace.path("").join(folder);
        fs::create_dir(&folder).unwrap();
        let program = folder.join("wayfield");
        symlink(env!("CARGO_BIN_EXE_wayfield"), &program).unwrap();
        for out in ["it's", "two words", "$(touch gone)", "-x*?", "new\nline \x1b[31m"] {
            let train = Command::new(&program)
                .args(["--train", "--steps", "16", "--out", &format!("./{out}")])
                .current_dir(workspace.path(""))
                .output()
                .unwrap();
            let (stdout, stderr) =
                (String::from_utf8(train.stdout).unwrap(), String::from_utf8_lossy(&train.stderr));
            assert_eq!(train.status.code(), Some(0), "{out}: {stderr}");
            let command = printed_command(&stdout);
            let Ok(pasted) =
                Command::new("bash").args(["-c", &command]).current_dir(workspace.path("")).output()
            else {
                return println!("skipped: there is no bash");
            };
            assert_eq!(
                pasted.status.code(),
                Some(0),
                "{command}\n{}",
                String::from_utf8_lossy(&pasted.stderr)
            );
        }
        assert!(!workspace.path("gone").exists());
    }

    #[test]
    fn file_names_cannot_control_the_terminal() {
        let workspace = Workspace::new();
        fs::create_dir(workspace.path("f")).unwrap();
        workspace.write("f/a\x1b[31m\n.ron", "(nam: 3)");
        workspace.write("f/b\u{202e}\u{9b}.ron", MINE);
        let done = workspace.run("--check f");
        assert_harmless(&done);
        assert!(done.stderr.starts_with(r"f/a\u{1b}[31m\u{a}.ron:1:2: unknown field"), "{}", done.stderr);
        assert_eq!(done.stdout, "f/b\\u{202e}\\u{9b}.ron: ok (scenario)\n");
        let done = workspace.run("--check f --json");
        assert_harmless(&done);
        assert_eq!(done.json()["files"][1], "f/b\u{202e}\u{9b}.ron", "escapes do not change the name");
        let words = ["\x1b]0;taken\x07", "--check", "f"].map(OsStr::new);
        assert_harmless(&workspace.run_words(words));
        assert_harmless(&workspace.run("--train --scenario f/b\u{202e}\u{9b}x.ron"));
    }

    #[test]
    fn a_presets_name_cannot_spoil_images_and_folders() {
        let workspace = Workspace::new();
        workspace.write("q\x08\x1b.ron", quick_fast());
        let done =
            workspace.run_words(["--train", "--steps", "16", "--preset", "q\x08\x1b.ron"].map(OsStr::new));
        assert_eq!(done.status, Some(0), "{}", done.stderr);
        assert_harmless(&done);
        let svg = workspace.text("runs/scenario-1-q__-0/learning-curve.svg");
        assert!(!svg.contains(|c: char| c.is_control() && c != '\n'), "{svg:?}");
    }
}

#[test]
fn the_metadata_of_a_policy_without_a_card_cannot_control_the_terminal() {
    let workspace = Workspace::new();
    workspace.run_ok("--train --steps 16 --out run");
    for (key, text) in [
        ("scenario", "\x1b]0;taken\x07\x1b[31mI\x1b[2K\u{202e}"),
        ("encoding", "\x1b[2J\x1b[31mx\u{9b}2J"),
        ("sensors", "\x1b[2J:1"),
    ] {
        let mut policy = Policy::from_bytes(&workspace.read("run/policy.safetensors")).unwrap();
        policy.card = None;
        policy.metadata.insert(key.into(), text.into());
        workspace.write("old.safetensors", policy.to_bytes().unwrap());
        let done = workspace.run("--eval old.safetensors --rounds 1 --episodes 1");
        assert_harmless(&done);
        assert!(done.stderr.contains(r"\u{1b}"), "{key} is printed: {}", done.stderr);
    }
}

#[test]
fn characters_that_cannot_be_printed_are_refused_in_names() {
    let workspace = Workspace::new();
    workspace.write("ff.ron", "(name: \"A\\u{ffff}B\", about: \"\\u{7}\")");
    let done = workspace.run("--check ff.ron");
    assert_refused(
        &done,
        "ff.ron:1:8: `name` contains the character U+FFFF, which can't be printed: remove it",
    );
    assert_refused(&done, "`about` contains the character U+0007");
}

#[test]
fn files_that_are_not_utf_8_are_refused_with_the_reason() {
    let workspace = Workspace::new();
    let utf16 = |text: &str| text.encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<u8>>();
    workspace.write("bom.ron", format!("\u{feff}{MINE}"));
    assert_eq!(workspace.run_ok("--check bom.ron").stdout, "bom.ron: ok (scenario)\n");
    workspace.write("marked.ron", utf16(&format!("\u{feff}{MINE}")));
    workspace.write("plain.ron", utf16(MINE));
    for name in ["marked.ron", "plain.ron"] {
        assert_refused(
            &workspace.run(&format!("--check {name}")),
            "is encoded as UTF-16: save the file as UTF-8",
        );
    }
    workspace.write("invalid.ron", b"\xef\xbb\xbf(name: \"M\xff\")");
    assert_refused(
        &workspace.run("--check invalid.ron"),
        "invalid.ron:1:10: the text is not valid UTF-8 from here on",
    );
    workspace.write("nul.ron", "(name: \"Mi\0ne\")");
    assert_refused(
        &workspace.run("--check nul.ron"),
        "nul.ron: this is not a text file: it contains NUL bytes",
    );
    workspace.write("crlf.ron", "\u{feff}(name: \"Mine\",\r\n\trobott: 3)\r\n");
    assert_refused(&workspace.run("--check crlf.ron"), "crlf.ron:2:2: unknown field `robott`");
}
