//! What a user gets for arguments and files that cannot be used: exit status 2, one clear message on stderr that
//! names the file, the line and the mend, nothing on stdout, and nothing left behind. And what is said when learning
//! itself fails, or when somebody asks for help.

mod cli_support;

use cli_support::{FAST, SCENARIO_1, Workspace, edited, quick_fast, raw};
use wayfield::policy::Policy;

/// A desk with a good preset, a run of one step, and its policy.
fn workspace() -> Workspace {
    let workspace = Workspace::new();
    workspace.write("quick.ron", quick_fast());
    workspace.run_ok("--train --preset quick.ron --steps 1 --out run");
    workspace
}

/// Asserts that `arguments` are refused as they should be, with a message that has every one of `needles`.
fn assert_refused(workspace: &Workspace, arguments: &str, needles: &[&str]) {
    let before = workspace.all_files();
    let done = workspace.run(arguments);
    let said = format!("wayfield {arguments}\n{}", done.stderr);
    assert_eq!(done.status, Some(2), "{said}");
    assert_eq!(done.stdout, "", "{said}");
    assert!(done.stderr.starts_with("error: "), "{said}");
    assert_eq!(done.stderr.matches("error: ").count(), 1, "one message: {said}");
    assert!(!done.stderr.contains("panicked") && !done.stderr.contains("RUST_BACKTRACE"), "{said}");
    for needle in needles {
        assert!(done.stderr.contains(needle), "`{needle}` is not in: {said}");
    }
    let after = workspace.all_files();
    let changed: Vec<_> =
        after.keys().chain(before.keys()).filter(|&k| before.get(k) != after.get(k)).collect();
    assert!(changed.is_empty(), "{said}left behind or changed: {changed:?}");
}

/// Asserts that `arguments` are refused in one line, beside having every one of `needles`.
fn assert_refused_in_a_line(workspace: &Workspace, arguments: &str, needles: &[&str]) {
    assert_refused(workspace, arguments, needles);
    let said = workspace.run(arguments).stderr;
    assert_eq!(said.lines().count(), 1, "{said}");
}

#[test]
fn scenarios_that_cannot_be_used() {
    let workspace = workspace();
    let broken = [
        (
            "comma.ron",
            ("radius_m: 0.15), position_m: (0.6, 0.6)", "radius_m: 0.15) position_m: (0.6, 0.6)"),
            &["comma.ron:13:40"][..],
        ),
        (
            "field.ron",
            ("    obstacles: [", "    obstacels: ["),
            &["field.ron:12:5", "obstacels", "did you mean `obstacles`?"],
        ),
        (
            "outside.ron",
            ("position_m: (0.6, 0.6)", "position_m: (1.95, 0.6)"),
            &["outside.ron:13:", "obstacles[0]", "beyond the enclosure", "move it inwards"],
        ),
        (
            "full.ron",
            ("    obstacles: [", "    goals: Random(clearance_m: 1.9),\n    obstacles: ["),
            &["full.ron:12:", "`goals`", "no free space", "smaller clearance_m"],
        ),
    ];
    for (name, edit, needles) in broken {
        workspace.write(name, edited(SCENARIO_1, &[edit]));
        let needles: Vec<&str> = needles.iter().copied().chain([name]).collect();
        assert_refused_in_a_line(
            &workspace,
            &format!("--train --preset quick.ron --scenario {name} --out new"),
            &needles,
        );
        assert_refused_in_a_line(
            &workspace,
            &format!("--eval run/policy.safetensors --scenario {name}"),
            &needles,
        );
    }
    for (arguments, needles) in [
        ("--train --scenario nothing/here.ron", &["nothing/here.ron", "no such"][..]),
        ("--train --scenario secnario-2", &["secnario-2: no such file", "did you mean `scenario-2`?"]),
        ("--train --scenario run", &["run", "folder"]),
        ("--eval run/policy.safetensors --scenario run/policy.safetensors", &["run/policy.safetensors"]),
    ] {
        assert_refused_in_a_line(&workspace, arguments, needles);
    }
}

#[test]
fn presets_that_cannot_be_used() {
    let workspace = workspace();
    let broken = [
        ("comma.ron", ("gamma: 0.95,", "gamma: 0.95"), &["comma.ron:19:9", "comma"][..]),
        ("field.ron", ("n_step: 2", "nstep: 2"), &["field.ron:19:9", "nstep", "did you mean `n_step`?"]),
        (
            "encoding.ron",
            ("    reward: (", "    observation: Row,\n    reward: ("),
            &["encoding.ron:7:", "`observation`", "did you mean `Raw`?"],
        ),
        (
            "arenas.ron",
            ("arenas: 16", "arenas: 0"),
            &["arenas.ron:4:13", "`arenas` is 0; help: give 1 to 4096"],
        ),
        (
            "batch.ron",
            ("batch_size: 64", "batch_size: 0"),
            &["batch.ron:24:", "`learning.batch_size`", "at least 1"],
        ),
        ("gamma.ron", ("gamma: 0.95", "gamma: 1.5"), &["gamma.ron:18:", "`learning.gamma`", "1.5"]),
        ("rate.ron", ("from: 0.0015", "from: NaN"), &["rate.ron:23:", "`learning.learning_rate", "NaN"]),
        (
            "layer.ron",
            ("hidden: [64, 64]", "hidden: [64, 0]"),
            &["layer.ron:16:", "`learning.network.hidden"],
        ),
        ("reward.ron", ("mu: 100.0", "mu: inf"), &["reward.ron:11:", "`reward.mu`"]),
        (
            "round.ron",
            ("every_env_steps: 5000", "every_env_steps: 0"),
            &["round.ron:6:", "every_env_steps` is 0"],
        ),
    ];
    for (name, edit, needles) in broken {
        workspace.write(name, edited(FAST, &[edit]));
        assert_refused_in_a_line(&workspace, &format!("--train --preset {name} --out new"), needles);
    }
    for (arguments, needles) in [
        ("--train --preset nothing.ron", &["nothing.ron: no such file"][..]),
        ("--train --preset per_d3qm", &["per_d3qm: no such file", "did you mean `per_d3qn`?"]),
        ("--train --preset zebra", &["zebra: no such file", "fast, dqn, per_d3qn, per_d3qn_tuned"]),
        ("--train --arenas 0", &["--arenas is 0; help: give 1 to 4096"]),
        ("--train --arenas 5000", &["--arenas is 5000; help: give 1 to 4096"]),
    ] {
        assert_refused_in_a_line(&workspace, arguments, needles);
    }
}

#[test]
fn policies_that_cannot_be_used() {
    let workspace = workspace();
    let good = workspace.read("run/policy.safetensors");
    let mut nan = good.clone();
    let end = nan.len();
    nan[end - 4..].copy_from_slice(&f32::NAN.to_le_bytes());
    workspace.write("nan.safetensors", &nan);
    workspace.write("truncated.safetensors", &good[..good.len() / 2]);
    workspace.write("header.safetensors", &good[..100]);
    workspace.write("empty.safetensors", b"");
    workspace.write("text.safetensors", "Dear reader, this is no policy at all.");
    workspace.write(
        "scenario.ron",
        edited(SCENARIO_1, &[("    obstacles: [", "    lidar: (beams: 12),\n    obstacles: [")]),
    );
    workspace.run_ok("--train --preset quick.ron --scenario scenario.ron --steps 1 --out twelve");

    let given = "give the policy.safetensors of a run";
    for (name, needles) in [
        ("nan.safetensors", &["NaN", "`value.weight`", "diverged"][..]),
        ("truncated.safetensors", &["not a safetensors file", given]),
        ("header.safetensors", &["not a safetensors file", given]),
        ("empty.safetensors", &["not a safetensors file", given]),
        ("text.safetensors", &["not a safetensors file", given]),
        ("absent.safetensors", &["can't be read", given]),
        ("run", &["is a folder", "give the policy.safetensors in it"]),
        (
            "twelve/policy.safetensors",
            &["16 numbers", "28 numbers", "24 beams", "\"Scenario I\"", "use the scenario it was trained in"],
        ),
    ] {
        let needles: Vec<&str> = needles.iter().copied().chain([name]).collect();
        assert_refused_in_a_line(&workspace, &format!("--eval {name}"), &needles);
        assert_refused_in_a_line(&workspace, &format!("--eval {name} --json"), &needles);
        assert_refused_in_a_line(
            &workspace,
            &format!("--train --preset quick.ron --init {name} --out new"),
            &needles,
        );
    }
    // The other way round, and another network for the same observations.
    assert_refused_in_a_line(
        &workspace,
        "--eval run/policy.safetensors --scenario scenario.ron",
        &["run/policy.safetensors", "28 numbers", "16 numbers", "12 beams"],
    );
    assert_refused_in_a_line(
        &workspace,
        "--train --preset fast --init run/policy.safetensors --out new",
        &["run/policy.safetensors", "16", "64"],
    );
}

#[test]
fn policies_of_another_encoding_cannot_be_started_from() {
    let workspace = workspace();
    workspace.write("raw.ron", raw(&quick_fast()));
    workspace.run_ok("--train --preset raw.ron --steps 1 --out raw");
    for (preset, init, needles) in [
        ("quick.ron", "raw", ["raw observations", "the preset's are scaled", "`observation: Raw`"]),
        ("raw.ron", "run", ["scaled observations", "the preset's are raw", "`observation: Scaled`"]),
    ] {
        let policy = format!("{init}/policy.safetensors");
        let needles: Vec<&str> = needles.into_iter().chain([policy.as_str()]).collect();
        assert_refused_in_a_line(
            &workspace,
            &format!("--train --preset {preset} --init {policy} --out new"),
            &needles,
        );
    }
    workspace.run_ok("--train --preset raw.ron --init raw/policy.safetensors --steps 1 --out onward");

    let mut later = Policy::from_bytes(&workspace.read("run/policy.safetensors")).unwrap();
    later.metadata.insert("encoding".into(), "logarithmic".into());
    workspace.write("later.safetensors", later.to_bytes().unwrap());
    for arguments in
        ["--eval later.safetensors", "--train --preset quick.ron --init later.safetensors --out new"]
    {
        let needles = ["later.safetensors", "\"logarithmic\"", "newer wayfield"];
        assert_refused_in_a_line(&workspace, arguments, &needles);
    }
}

#[test]
fn places_where_no_run_can_be_written() {
    let workspace = workspace();
    workspace.write("file", "in the way");
    for out in ["file", "file/below", "/proc/wayfield", "/dev/null/run"] {
        let needles = [out, "can't be written", "give --out another folder"];
        assert_refused_in_a_line(&workspace, &format!("--train --preset quick.ron --out {out}"), &needles);
    }
    // The default folder as well.
    workspace.write("runs", "in the way");
    assert_refused_in_a_line(
        &workspace,
        "--train --preset quick.ron",
        &["runs/scenario-1-quick-0", "can't be written"],
    );
}

#[test]
fn arguments_that_cannot_be_used() {
    let workspace = workspace();
    for (arguments, needles) in [
        ("--train --seed abc", &["'abc'", "--seed", "give a whole number from 0"][..]),
        ("--train --seed -1", &["'-1'", "--seed", "give a whole number from 0"]),
        ("--train --seed 1.5", &["'1.5'", "--seed"]),
        ("--train --episodes 0", &["'0'", "--episodes"]),
        ("--train --steps 0", &["'0'", "--steps"]),
        ("--train --episodes 5 --steps 5", &["--episodes", "--steps"]),
        ("--train --arenas two", &["'two'", "--arenas"]),
        ("--train --init run/policy.safetensors --epsilon 2", &["--epsilon is 2", "give 0 to 1"]),
        ("--train --init run/policy.safetensors --epsilon NaN", &["--epsilon is NaN", "give 0 to 1"]),
        ("--train --init run/policy.safetensors --epsilon=-0.1", &["--epsilon is -0.1", "give 0 to 1"]),
        ("--train --epsilon 0.5", &["--init"]),
        ("--train --eval run/policy.safetensors", &["--train", "--eval"]),
        ("--train --resume run --seed 3", &["--resume", "--seed"]),
        ("--train --resume run --preset fast", &["--resume", "--preset"]),
        ("--train --resume run --out new", &["--resume", "--out"]),
        ("--resume run", &["--train"]),
        ("--train --rounds 3", &["--rounds", "--train"]),
        ("--train --course", &["--course", "--train"]),
        ("--draw map.svg --episodes 9", &["--episodes", "--draw", "'--train'"]),
        ("--steps 9", &["--steps", "'--train'"]),
        ("--train --resume run --epsilon 0.5", &["--epsilon", "--resume"]),
        ("--eval run/policy.safetensors --preset fast", &["--preset", "--eval"]),
        ("--eval run/policy.safetensors --epsilon 0.5 --init run/policy.safetensors", &["--eval"]),
        ("--eval run/policy.safetensors --out new", &["--out", "--eval"]),
        ("--eval run/policy.safetensors --rounds 0", &["'0'", "--rounds"]),
        ("--eval run/policy.safetensors --rounds 10000 --episodes 10000", &["100000000", "1000000"]),
        ("--eval", &["--eval", "POLICY"]),
        ("--json", &["--train", "--eval"]),
        ("--trian", &["--trian", "--train"]),
        ("run", &["'run'"]),
    ] {
        assert_refused(&workspace, arguments, needles);
    }
}

#[test]
fn runs_that_cannot_be_resumed() {
    let workspace = workspace();
    assert_refused_in_a_line(
        &workspace,
        "--train --resume absent",
        &["absent: is no run's folder", "--resume"],
    );
    workspace.write("plain", "");
    assert_refused_in_a_line(&workspace, "--train --resume plain", &["plain", "no run's folder"]);

    // (Or the one before would be taken: tests/cli_crash_recovery.rs.)
    std::fs::remove_file(workspace.path("run/checkpoint/previous.bin")).unwrap();
    let (checkpoint, config) =
        (workspace.read("run/checkpoint/latest.bin"), workspace.text("run/config.ron"));
    let resume = "--train --resume run --steps 2000";
    let mut flipped = checkpoint.clone();
    let middle = flipped.len() / 2;
    flipped[middle] ^= 0x10;
    let mut head = checkpoint.clone();
    head[40] ^= 0x10;
    let mut version = checkpoint.clone();
    version[8] = 99;
    for (bytes, needle) in [
        (&flipped[..], "damaged"),
        (&head[..], "damaged"),
        (&version[..], "version 99"),
        (&checkpoint[..checkpoint.len() - 10], ""),
        (&checkpoint[..10], "too short"),
        (b"Dear reader, this is no checkpoint.", "no checkpoint"),
    ] {
        workspace.write("run/checkpoint/latest.bin", bytes);
        assert_refused_in_a_line(&workspace, resume, &["run/checkpoint/latest.bin", needle]);
    }
    std::fs::remove_file(workspace.path("run/checkpoint/latest.bin")).unwrap();
    // (Without a row on record it was killed before its first step, and begins.)
    let rows = workspace.text("run/episodes.csv");
    workspace.write("run/episodes.csv", format!("{rows}one more\n"));
    assert_refused_in_a_line(
        &workspace,
        resume,
        &["run/checkpoint/latest.bin", "no checkpoint to go on from"],
    );
    workspace.write("run/checkpoint/latest.bin", &checkpoint);

    // A config.ron that was edited so that it no longer fits its checkpoint, or anything.
    for (from, to, needle) in [
        ("arenas: 16", "arenas: 8", "number of arenas"),
        ("gamma: 0.95", "gamma: 0.9", ""),
        ("beams: 24", "beams: 12", ""),
        ("gamma: 0.95", "gamma: 95", "gamma"),
        ("gamma: 0.95", "gamma: zebra", "run/config.ron:"),
    ] {
        workspace.write("run/config.ron", edited(&config, &[(from, to)]));
        assert_refused_in_a_line(&workspace, resume, &["run/", needle]);
    }
    workspace.write("run/config.ron", &config);
    workspace.run_ok(resume);
}

#[test]
fn help_tells_of_every_flag_and_version_is_the_crates() {
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
        "--episodes",
        "--course",
        "--help",
        "--version",
    ] {
        let has = |line: &str| line.split([' ', ',']).any(|word| word == flag);
        let mut lines =
            help.stdout.lines().skip_while(|line| !(line.trim_start().starts_with('-') && has(line)));
        let Some(line) = lines.next() else { panic!("{flag} is not in\n{}", help.stdout) };
        let tells = line.trim_start().split_once("  ").map(|(_, text)| text.trim()).unwrap_or_default();
        assert!(tells.len() >= 10, "{flag} has no description in\n{}", help.stdout);
    }
    for word in ["scenario-1", "per_d3qn", "fast", "Exit status"] {
        assert!(help.stdout.contains(word), "`{word}` is not in\n{}", help.stdout);
    }
    assert!(workspace.run_ok("-h").stdout.len() <= help.stdout.len());
    assert_eq!(workspace.run_ok("--version").stdout, format!("wayfield {}\n", env!("CARGO_PKG_VERSION")));
}

#[test]
fn without_arguments_one_sentence_says_what_can_be_done() {
    let needles: &[&str] = if cfg!(feature = "gui") {
        &["no display", "wayfield --train"]
    } else {
        &["wayfield --train", "wayfield --eval", "--help"]
    };
    assert_refused_in_a_line(&Workspace::new(), "", needles);
}
