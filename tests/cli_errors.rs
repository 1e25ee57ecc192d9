//! Tests of invalid arguments and files: exit status 2, one message on stderr that names the file, the line and a
//! fix, nothing on stdout, and no file created or changed. Also tests of the help text.
//!
//! The messages are compared with `tests/snapshots/messages/`, one file per test. `cargo xtask messages` regenerates them.

mod cli_support;

use cli_support::messages::Messages;
use cli_support::{FAST, SCENARIO_1, Workspace, edited, quick_fast, raw};
use wayfield::policy::Policy;

/// A workspace with a valid preset and a run of one step.
fn workspace() -> Workspace {
    let workspace = Workspace::new();
    workspace.write("quick.ron", quick_fast());
    workspace.run_ok("--train --preset quick.ron --steps 1 --out run");
    workspace
}

#[test]
fn invalid_scenarios_are_rejected() {
    let workspace = workspace();
    let mut messages = Messages::new("scenarios");
    for (name, edit) in [
        ("comma.ron", ("radius_m: 0.15), position_m: (0.6, 0.6)", "radius_m: 0.15) position_m: (0.6, 0.6)")),
        ("field.ron", ("    obstacles: [", "    obstacels: [")),
        ("outside.ron", ("position_m: (0.6, 0.6)", "position_m: (1.95, 0.6)")),
        ("full.ron", ("    obstacles: [", "    goals: Random(clearance_m: 1.9),\n    obstacles: [")),
    ] {
        workspace.write(name, edited(SCENARIO_1, &[edit]));
        messages.line(&workspace, &format!("--train --preset quick.ron --scenario {name} --out new"));
        messages.line(&workspace, &format!("--eval run/policy.safetensors --scenario {name}"));
    }
    for arguments in [
        "--train --scenario nothing/here.ron",
        "--train --scenario secnario-2",
        "--train --scenario run",
        "--eval run/policy.safetensors --scenario run/policy.safetensors",
    ] {
        messages.line(&workspace, arguments);
    }
    messages.check();
}

#[test]
fn invalid_presets_are_rejected() {
    let workspace = workspace();
    let mut messages = Messages::new("presets");
    for (name, edit) in [
        ("comma.ron", ("gamma: 0.95,", "gamma: 0.95")),
        ("field.ron", ("n_step: 2", "nstep: 2")),
        ("encoding.ron", ("    reward: (", "    observation: Row,\n    reward: (")),
        ("arenas.ron", ("arenas: 16", "arenas: 0")),
        ("batch.ron", ("batch_size: 64", "batch_size: 0")),
        ("gamma.ron", ("gamma: 0.95", "gamma: 1.5")),
        ("rate.ron", ("from: 0.0015", "from: NaN")),
        ("layer.ron", ("hidden: [64, 64]", "hidden: [64, 0]")),
        ("reward.ron", ("mu: 100.0", "mu: inf")),
        ("round.ron", ("every_env_steps: 5000", "every_env_steps: 0")),
        ("levels.ron", ("arenas: 16,", "levels: ByProgress(uniform: 1.5), arenas: 16,")),
        ("mirror.ron", ("n_step: 2", "mirror: true, n_step: 2")),
    ] {
        workspace.write(name, edited(FAST, &[edit]));
        messages.line(&workspace, &format!("--train --preset {name} --out new"));
    }
    for arguments in ["--train --preset nothing.ron", "--train --preset per_d3qm", "--train --preset zebra"] {
        messages.line(&workspace, arguments);
    }
    messages.check();
}

#[test]
fn invalid_policies_are_rejected() {
    let workspace = workspace();
    let mut messages = Messages::new("policies");
    let valid = workspace.read("run/policy.safetensors");
    let mut nan = valid.clone();
    let end = nan.len();
    nan[end - 4..].copy_from_slice(&f32::NAN.to_le_bytes());
    workspace.write("nan.safetensors", &nan);
    workspace.write("truncated.safetensors", &valid[..valid.len() - 100]);
    workspace.write("header.safetensors", &valid[..100]);
    workspace.write("empty.safetensors", b"");
    workspace.write("text.safetensors", "This is not a policy.");
    workspace.write(
        "scenario.ron",
        edited(SCENARIO_1, &[("    obstacles: [", "    lidar: (beams: 12),\n    obstacles: [")]),
    );
    workspace.run_ok("--train --preset quick.ron --scenario scenario.ron --steps 1 --out twelve");

    for name in [
        "nan.safetensors",
        "truncated.safetensors",
        "header.safetensors",
        "empty.safetensors",
        "text.safetensors",
        "absent.safetensors",
        "run",
        "twelve/policy.safetensors",
    ] {
        messages.line(&workspace, &format!("--eval {name} --scenario scenario-1"));
        messages.line(&workspace, &format!("--eval {name} --scenario scenario-1 --json"));
        messages.line(&workspace, &format!("--train --preset quick.ron --init {name} --out new"));
    }
    // A policy for another number of beams, and one with a network of another size.
    messages.line(&workspace, "--eval run/policy.safetensors --scenario scenario.ron");
    messages.line(&workspace, "--train --preset fast --init run/policy.safetensors --out new");
    messages.check();
}

#[test]
fn a_run_cannot_start_from_a_policy_with_another_encoding() {
    let workspace = workspace();
    let mut messages = Messages::new("encodings");
    workspace.write("raw.ron", raw(&quick_fast()));
    workspace.run_ok("--train --preset raw.ron --steps 1 --out raw");
    messages.line(&workspace, "--train --preset quick.ron --init raw/policy.safetensors --out new");
    messages.line(&workspace, "--train --preset raw.ron --init run/policy.safetensors --out new");
    workspace.run_ok("--train --preset raw.ron --init raw/policy.safetensors --steps 1 --out transferred");

    let mut newer = Policy::from_bytes(&workspace.read("run/policy.safetensors")).unwrap();
    newer.card = None;
    newer.metadata.insert("encoding".into(), "logarithmic".into());
    workspace.write("newer.safetensors", newer.to_bytes().unwrap());
    messages.line(&workspace, "--eval newer.safetensors");
    messages.line(&workspace, "--eval newer.safetensors+map");
    messages.line(&workspace, "--train --preset quick.ron --init newer.safetensors --out new");
    messages.check();
}

#[cfg(target_os = "linux")]
#[test]
fn output_folders_that_cannot_be_written_are_rejected() {
    let workspace = workspace();
    let mut messages = Messages::new("output_folders");
    workspace.write("file", "");
    for out in ["file", "file/below", "/proc/wayfield", "/dev/null/run"] {
        messages.line(&workspace, &format!("--train --preset quick.ron --out {out}"));
    }
    // The default folder cannot be written either.
    workspace.write("runs", "");
    messages.line(&workspace, "--train --preset quick.ron");
    messages.check();
}

#[cfg(target_os = "linux")]
#[test]
fn output_files_that_cannot_be_written_are_rejected() {
    let workspace = workspace();
    let mut messages = Messages::new("output_files");
    std::fs::create_dir(workspace.path("folder.svg")).unwrap();
    workspace.write("read-only.svg", "");
    let mut permissions = std::fs::metadata(workspace.path("read-only.svg")).unwrap().permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(workspace.path("read-only.svg"), permissions).unwrap();
    for file in [
        "map.gif",
        "map",
        "folder.svg",
        "folder.svg/",
        "absent/map.svg",
        "quick.ron/map.svg",
        "/proc/map.svg",
        "read-only.svg",
    ] {
        messages.line(&workspace, &format!("--draw {file}"));
    }
    messages.check();
}

#[test]
fn invalid_arguments_are_rejected() {
    let workspace = workspace();
    let mut messages = Messages::new("arguments");
    for arguments in [
        "--train --seed abc",
        "--train --seed -1",
        "--train --seed 1.5",
        "--train --episodes 0",
        "--train --steps 0",
        "--train --episodes 5 --steps 5",
        "--train --arenas two",
        "--train --arenas 0",
        "--train --arenas 5000",
        "--train --steps 600,000",
        "--train --seed 1e30",
        "--train --init run/policy.safetensors --epsilon 0,5",
        "--train --init run/policy.safetensors --epsilon 2",
        "--train --init run/policy.safetensors --epsilon NaN",
        "--train --init run/policy.safetensors --epsilon=-0.1",
        "--train --epsilon 0.5",
        "--train --eval run/policy.safetensors",
        "--train --resume run --seed 3",
        "--train --resume run --preset fast",
        "--train --resume run --out new",
        "--train --resume run --set learning.gamma=0.97",
        "--train run/config.ron --resume run",
        "--train run/config.ron --scenario maze",
        "--train --set learning.gama=0.97",
        "--train --set learning.gamma=0,97",
        "--train --set learning.learning_rate=3e-4",
        "--train --set scenario.lidar.beams=0 --set arenas=many",
        "--train --set learning.gamma",
        "--eval run/policy.safetensors --set learning.gamma=0.97",
        "--set scenario.lidar.beams=8",
        "--scenario run/config.ron",
        "--resume run",
        "--steps 9",
        "--train --rounds 3",
        "--train --course",
        "--draw map.svg --episodes 9",
        "--train --resume run --epsilon 0.5",
        "--eval run/policy.safetensors --preset fast",
        "--eval run/policy.safetensors --epsilon 0.5 --init run/policy.safetensors",
        "--eval run/policy.safetensors --out new",
        "--eval run/policy.safetensors --rounds 0",
        "--eval run/policy.safetensors --rounds 10000 --episodes 10000",
        "--eval",
        "--json",
        "--trian",
        "run",
    ] {
        messages.add(&workspace, arguments);
    }
    messages.check();
}

#[test]
fn invalid_run_folders_are_rejected() {
    let workspace = workspace();
    let mut messages = Messages::new("run_folders");
    messages.line(&workspace, "--train --resume absent");
    workspace.write("plain", "");
    messages.line(&workspace, "--train --resume plain");

    // Otherwise previous.bin would be used in place of an invalid latest.bin (tests/cli_crash_recovery.rs).
    std::fs::remove_file(workspace.path("run/checkpoint/previous.bin")).unwrap();
    let checkpoint = workspace.read("run/checkpoint/latest.bin");
    let resume = "--train --resume run --steps 2000";
    let changed = |position: usize, change: fn(&mut u8)| {
        let mut bytes = checkpoint.clone();
        change(&mut bytes[position]);
        bytes
    };
    for (case, bytes) in [
        ("a flipped bit in the middle", changed(checkpoint.len() / 2, |byte| *byte ^= 0x10)),
        ("a flipped bit in the head", changed(40, |byte| *byte ^= 0x10)),
        ("another version", changed(8, |byte| *byte = 99)),
        ("without the last 10 bytes", checkpoint[..checkpoint.len() - 10].to_vec()),
        ("the first 10 bytes only", checkpoint[..10].to_vec()),
        ("another file", b"This is not a checkpoint of any kind.".to_vec()),
    ] {
        workspace.write("run/checkpoint/latest.bin", bytes);
        messages.case(&format!("latest.bin: {case}"));
        messages.line(&workspace, resume);
    }
    std::fs::remove_file(workspace.path("run/checkpoint/latest.bin")).unwrap();
    // A run without rows was killed before its first step and needs no checkpoint, so add a row.
    let rows = workspace.text("run/episodes.csv");
    workspace.write("run/episodes.csv", format!("{rows}one more\n"));
    messages.case("without latest.bin");
    messages.line(&workspace, resume);
    workspace.write("run/checkpoint/latest.bin", &checkpoint);

    // An edited config.ron that no longer fits the checkpoint, or is invalid.
    let config = workspace.text("run/config.ron");
    for (from, to) in [
        ("arenas: 16", "arenas: 8"),
        ("gamma: 0.95", "gamma: 0.9"),
        ("beams: 24", "beams: 12"),
        ("gamma: 0.95", "gamma: 95"),
        ("gamma: 0.95", "gamma: zebra"),
    ] {
        workspace.write("run/config.ron", edited(&config, &[(from, to)]));
        messages.case(&format!("config.ron: {to}"));
        messages.line(&workspace, resume);
    }
    workspace.write("run/config.ron", &config);
    workspace.run_ok(resume);
    messages.check();
}

#[test]
fn help_describes_the_flags_and_version_prints_the_crate_version() {
    let workspace = Workspace::new();
    let help = workspace.run_ok("--help");
    assert_eq!(help.stderr, "");
    for flag in [
        "--train",
        "--eval",
        "--scenario",
        "--seed",
        "--json",
        "--preset",
        "--episodes",
        "--steps",
        "--arenas",
        "--out",
        "--init",
        "--epsilon",
        "--resume",
        "--rounds",
        "--course",
        "--help",
        "--version",
    ] {
        let has = |line: &str| line.split([' ', ',']).any(|word| word == flag);
        let mut lines =
            help.stdout.lines().skip_while(|line| !(line.trim_start().starts_with('-') && has(line)));
        let Some(line) = lines.next() else { panic!("{flag} is not in\n{}", help.stdout) };
        let description = line.trim_start().split_once("  ").map(|(_, text)| text.trim()).unwrap_or_default();
        assert!(description.len() >= 10, "{flag} has no description in\n{}", help.stdout);
    }
    for word in ["scenario-1", "per_d3qn", "fast", "Exit status"] {
        assert!(help.stdout.contains(word), "`{word}` is not in\n{}", help.stdout);
    }
    assert_eq!(
        help.stdout.contains("the app"),
        cfg!(feature = "gui"),
        "the app is offered only if there is one"
    );
    assert!(workspace.run_ok("-h").stdout.len() <= help.stdout.len());
    assert_eq!(workspace.run_ok("--version").stdout, format!("wayfield {}\n", env!("CARGO_PKG_VERSION")));
}

#[test]
fn without_a_display_or_without_the_app_one_line_names_the_other_modes() {
    let needles: &[&str] = if cfg!(feature = "gui") {
        &["no display", "wayfield --train"]
    } else {
        &["wayfield --train", "wayfield --eval", "--help"]
    };
    let message = cli_support::messages::rejection(&Workspace::new(), "");
    assert_eq!(message.lines().count(), 1, "{message}");
    for needle in needles {
        assert!(message.contains(needle), "`{needle}` is not in: {message}");
    }
}
