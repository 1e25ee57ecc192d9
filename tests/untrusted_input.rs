//! Untrusted input: whatever is in them, they are read or refused, without a panic, at once, and without much memory.
//! The fuzzers of `fuzz/` go on from here with chance and time.

#[path = "support/untrusted_input.rs"]
mod untrusted_input;

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use wayfield::learning::{NetworkShape, QNetwork};
use wayfield::random::{Stream, stream, uniform_index};
use wayfield::run::checkpoint::TrainerState;

/// What becomes of bytes of one kind: whether they were sound.
type Reader = fn(&[u8]) -> bool;

const KINDS: [(&str, Reader); 5] = [
    ("policy", untrusted_input::policy),
    ("checkpoint", untrusted_input::checkpoint),
    ("scenario", untrusted_input::scenario),
    ("preset", untrusted_input::preset),
    ("experiment", untrusted_input::experiment),
];
/// The most time that one file may take.
const LONGEST: Duration = Duration::from_secs(if cfg!(debug_assertions) { 20 } else { 1 });
/// The most memory that this process may ever have had, in kB: all files of all tests, one after another or at once.
const MOST_KB: u64 = 400_000;

/// Lets `reader` have `bytes`, and looks at the clock and at the process's peak of memory.
fn reads(what: &str, reader: Reader, bytes: &[u8]) -> bool {
    let begun = (Instant::now(), of_thread());
    let sound = reader(bytes);
    let took = match (begun.1, of_thread()) {
        (Some(from), Some(to)) => to.saturating_sub(from),
        _ => begun.0.elapsed(),
    };
    assert!(took < LONGEST, "{what}: took {took:?}");
    if let Some(peak) = peak_kb() {
        assert!(peak < MOST_KB, "{what}: the process has had {peak} kB");
    }
    sound
}

/// The time that this thread has been at work, where the system tells: what others do beside it does not count.
fn of_thread() -> Option<Duration> {
    let status = fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    Some(Duration::from_nanos(status.split_whitespace().next()?.parse().ok()?))
}

/// The most memory that this process has had, in kB, where the system tells.
fn peak_kb() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    line.split_whitespace().nth(1)?.parse().ok()
}

fn project(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// The files in a folder of the project, in the order of their names.
fn files(folder: &str) -> Vec<(String, Vec<u8>)> {
    let entries = fs::read_dir(project(folder)).unwrap_or_else(|error| panic!("{folder}: {error}"));
    let mut paths: Vec<_> = entries.map(|entry| entry.expect("an entry").path()).collect();
    paths.retain(|path| path.is_file());
    paths.sort();
    let read = |path: PathBuf| (path.display().to_string(), fs::read(&path).expect("it can be read"));
    paths.into_iter().map(read).collect()
}

/// A policy of so many numbers, as a file.
fn small_policy(dueling: bool) -> Vec<u8> {
    let shape = NetworkShape { inputs: 2, hidden: vec![2], actions: 2, dueling };
    let network = QNetwork::new(shape, &mut stream(1, "weights", 0)).expect("a shape that can be");
    let metadata = [("encoding", "raw"), ("scenario", "x")].map(|(key, value)| (key.into(), value.into()));
    network.to_policy(metadata.into()).to_bytes().expect("its weights are finite")
}

/// The same in the form in which the length of the header is always right.
fn framed(policy: &[u8]) -> Vec<u8> {
    [b"S", &policy[..2], &policy[8..]].concat()
}

/// Sound files to begin with, of each kind.
fn seeds(kind: &str) -> Vec<(String, Vec<u8>)> {
    match kind {
        "policy" => {
            let both = [false, true].map(small_policy);
            let framed = both.each_ref().map(|policy| framed(policy));
            both.into_iter()
                .chain(framed)
                .enumerate()
                .map(|(k, bytes)| (format!("small-{k}"), bytes))
                .collect()
        }
        "checkpoint" => {
            let made = |steps| (format!("after-{steps}"), untrusted_input::valid_checkpoint(steps));
            [0, 3, 30].map(made).into()
        }
        "scenario" => files("scenarios").into_iter().chain([everything()]).collect(),
        "preset" => files("assets/presets"),
        _ => files("assets/experiments"),
    }
}

/// A scenario with something of every kind.
fn everything() -> (String, Vec<u8>) {
    (
        "everything".into(),
        fs::read(project("crates/scenario/tests/fixtures/everything.ron")).expect("it is there"),
    )
}

#[test]
fn valid_files_are_accepted_and_used() {
    for (kind, reader) in KINDS {
        let seeds = seeds(kind);
        assert!(seeds.len() >= 3, "{kind}");
        for (name, bytes) in &seeds {
            assert!(reads(name, reader, bytes), "{kind} {name} is sound");
        }
        // What the fuzzers begin with (see fuzz/README.md).
        if let Some(folder) = std::env::var_os("WAYFIELD_FUZZ_SEEDS") {
            let folder = Path::new(&folder).join(kind);
            fs::create_dir_all(&folder).expect("a folder for seeds");
            for (name, bytes) in seeds {
                let name = Path::new(&name).file_name().expect("a name");
                fs::write(folder.join(name), bytes).expect("a seed is written");
            }
        }
    }
}

/// What is changed in where a run stands, so that it cannot go on from there.
type Breakage = (&'static str, fn(&mut TrainerState));

#[test]
fn a_checkpoint_with_numbers_that_no_run_has_is_refused() {
    let sound = untrusted_input::valid_checkpoint(3);
    let length = usize::from(u16::from_le_bytes([sound[0], sound[1]]));
    let trainer_state: TrainerState = postcard::from_bytes(&sound[4..4 + length]).expect("its head");
    let with = |trainer_state: &TrainerState| {
        let head = postcard::to_allocvec(trainer_state).expect("a head");
        [&(head.len() as u16).to_le_bytes(), &sound[2..4], &head, &sound[4 + length..]].concat()
    };
    assert!(untrusted_input::checkpoint(&with(&trainer_state)), "as it was");
    let breakages: &[Breakage] = &[
        ("a pose that is none", |s| s.arenas[0].pose.x_m = f32::NAN),
        ("a robot beyond all walls", |s| s.arenas[1].pose.y_m = 1e30),
        ("a clock at its end", |s| s.arenas[0].clock.0 = u64::MAX),
        ("a scan of no beams", |s| s.arenas[0].scan.ranges_m.clear()),
        ("a scan of too many beams", |s| s.arenas[0].scan.ranges_m.push(1.0)),
        ("a late scan of no beams", |s| s.arenas[0].scan.delayed[0].1.clear()),
        ("an episode at its end", |s| s.arenas[0].episode.steps = u32::MAX),
        ("an arena that stands still", |s| s.arenas[0].episode.inactive = true),
        ("one arena too few", |s| s.arenas.truncate(1)),
        ("one stream too few", |s| s.exploration.truncate(1)),
        ("a last row that is none", |s| s.means = Some((f64::NAN, 0.0, 0.0))),
        ("a last return that is none", |s| s.recent_returns.push_back(f64::INFINITY)),
        ("too many last returns", |s| s.recent_returns.resize(101, 0.0)),
        ("an evaluation after the end of numbers", |s| s.next_evaluation = u64::MAX),
        ("a success rate beyond 1", |s| s.last_success_rate = Some(1.5)),
        ("a best policy that is none", |s| s.best.as_mut().expect("it has one").bytes.truncate(100)),
        ("a wall time that is none", |s| s.wall_s = f64::NAN),
        ("sums that are none", |s| s.stats.loss = f64::NAN),
    ];
    for (what, breakage) in breakages {
        let mut broken = trainer_state.clone();
        breakage(&mut broken);
        assert!(!untrusted_input::checkpoint(&with(&broken)), "{what}");
    }
}

#[test]
fn every_case_that_was_found_goes_through() {
    for (kind, reader) in KINDS {
        for (name, bytes) in files(&format!("tests/fixtures/untrusted_input/{kind}")) {
            reads(&name, reader, &bytes);
        }
    }
}

/// Numbers that are written into files where others stood.
const NASTY: [&str; 16] = [
    "0",
    "-1",
    "1e38",
    "-1e38",
    "1e-45",
    "NaN",
    "inf",
    "-inf",
    "18446744073709551615",
    "4294967295",
    "-9223372036854775808",
    "1e400",
    "0.0000001",
    "4096",
    "16777216",
    "65536",
];

/// `bytes` with some change.
fn mutated(bytes: &[u8], text: bool, random: &mut Stream) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..1 + uniform_index(random, 3) {
        let at = uniform_index(random, bytes.len().max(1));
        let to = (at + 1 + uniform_index(random, 40)).min(bytes.len());
        match uniform_index(random, 6) {
            0 => drop(bytes.drain(at.min(to)..to)),
            1 => {
                let piece = bytes[at.min(to)..to].to_vec();
                let place = uniform_index(random, bytes.len() + 1);
                bytes.splice(place..place, piece);
            }
            2 if !bytes.is_empty() => bytes[at] = uniform_index(random, 256) as u8,
            3 if !bytes.is_empty() => bytes[at] ^= 1 << uniform_index(random, 8),
            _ if text => {
                // The first number from here on becomes another.
                let digit = |byte: &u8| byte.is_ascii_digit() || matches!(byte, b'-' | b'.');
                let Some(start) = bytes[at.min(to)..].iter().position(digit).map(|k| k + at) else {
                    continue;
                };
                let end = start + bytes[start..].iter().take_while(|byte| digit(byte)).count();
                bytes.splice(start..end, NASTY[uniform_index(random, NASTY.len())].bytes());
            }
            _ => {
                let nasty = [0_u8, 0xFF, 0x7F, 0x80][uniform_index(random, 4)];
                let end = (at + 4).min(bytes.len());
                bytes[at.min(end)..end].fill(nasty);
            }
        }
    }
    bytes
}

#[test]
fn mutated_valid_files_never_panic() {
    for (kind, reader) in KINDS {
        let (mut random, mut sound) = (stream(20, kind, 0), 0);
        let seeds = seeds(kind);
        let text = !matches!(kind, "policy" | "checkpoint");
        let each = 1_500 / seeds.len();
        for (name, bytes) in &seeds {
            for number in 0..each {
                let changed = mutated(bytes, text, &mut random);
                sound += usize::from(reads(&format!("{name}, change {number}"), reader, &changed));
            }
        }
        assert!(
            (20..1_400).contains(&sound),
            "{kind}: {sound} of 1,500 still sound, so the changes get everywhere"
        );
    }
}

/// The kinds that are RON text.
fn texts() -> impl Iterator<Item = (&'static str, Reader)> {
    KINDS.into_iter().filter(|(kind, _)| !matches!(*kind, "policy" | "checkpoint"))
}

const MIB: usize = 1 << 20;

#[test]
fn a_mebibyte_of_anything_is_refused_at_once() {
    let pieces = [
        "(",
        "[",
        "{",
        ")",
        "((",
        "Some(",
        "[[(",
        "a(",
        "(a:",
        "(name:(",
        "#![enable(",
        "/*",
        "/**/",
        "//\n",
        "\n",
        " ",
        ",",
        ":",
        "\"",
        "\\",
        "'",
        "a",
        "a,",
        "é",
        "\u{1F916}",
        "0",
        "0,",
        "-",
        "1e",
        ".",
        "0x",
        "_",
        "r#",
        "r\"",
        "b'",
        "(0,0),",
        "\"a\",",
        "\0",
        "#",
        "!",
    ];
    for (kind, reader) in texts() {
        let list = match kind {
            "scenario" => "(obstacles: [",
            "preset" => "(learning: (network: (hidden: [",
            _ => "(arms: [",
        };
        for start in ["", "(about: \"", list] {
            for piece in pieces {
                let mut text = start.to_string();
                text.push_str(&piece.repeat((MIB - start.len()) / piece.len()));
                let sound = reads(&format!("{kind}: {start}{piece}..."), reader, text.as_bytes());
                assert!(!sound);
            }
        }
    }
}

/// `text` with `field` at its end in the outermost brackets.
fn with(text: &str, field: &str) -> String {
    let end = text.rfind(')').expect("it ends with a bracket");
    format!("{} {field} {}", text[..end].trim_end().trim_end_matches(',').to_string() + ",", &text[end..])
}

#[test]
fn long_lists_of_what_is_well_formed_are_read_or_refused_at_once() {
    let fill = |head: &str, piece: &str, tail: &str| {
        format!("{head}{}{tail}", piece.repeat((MIB - head.len() - tail.len()) / piece.len()))
    };
    let scenario = "(name: \"x\", benchmark_route: (start_m: (-1.0, -1.0), goal_m: (1.2, 1.2)), ";
    let still = "(shape: Circle(radius_m: 0.01), position_m: (0.5, 0.5)),";
    let wrong = "(shape: Circle(radius_m: -1), position_m: (900, nan)),";
    let turning = "(shape: Rectangle(width_m: 0.01, height_m: 0.01), position_m: (0.3, 0.5), motion: RandomWalk(radius_m: \
                   0.1, speed_m_s: 0.1)),";
    let walls = "(corners_m: [(0.5, 0.5), (0.6, 0.5)]),";
    let generator = "(count: 12, shape: Circle(radius_m: (0.01, 0.02))),";
    let cases = [
        fill(&format!("{scenario}obstacles: ["), still, "])"),
        fill(&format!("{scenario}obstacles: ["), wrong, "])"),
        fill(&format!("{scenario}obstacles: ["), turning, "])"),
        fill(&format!("{scenario}walls: ["), walls, "])"),
        fill(&format!("{scenario}generators: ["), generator, "])"),
        fill(&format!("{scenario}enclosure: Polygon(corners_m: ["), "(0,1),(1,0),", "]))"),
        fill(&format!("{scenario}robot: (motions: ["), "(v_m_s: 9, w_rad_s: 99),", "]))"),
        fill(&format!("{scenario}starts: OneOf(positions_m: ["), "(0,1),", "]))"),
        fill("(", "nam: 1,", ")"),
        fill("(", "name: \"a\",", ")"),
        format!("{scenario}obstacles: [{}])", turning.repeat(8_000)),
        format!("{scenario}obstacles: [{}])", still.repeat(10_000)),
        format!("{scenario}generators: [{}])", generator.repeat(16)),
        format!("{scenario}walls: [{}])", walls.repeat(1_000)),
    ];
    for (number, text) in cases.iter().enumerate() {
        reads(&format!("long scenario {number}"), untrusted_input::scenario, text.as_bytes());
    }
    let stage = "(scenario: \"empty\", preset: \"fast\", budget: Some(Episodes(18446744073709551615))),";
    let arms = |from: usize, count: usize| -> String {
        (from..from + count).map(|k| format!("(name: \"{k}\", stages: [{stage}]),")).collect()
    };
    let claims = "(says: \"\", measure: Success, better: \"x\", than: \"y\", after: 7),".repeat(4_000);
    let table = format!(
        "tables: [(name: \"t\", title: \"t\", show: Measures(measures: [], after: 1), claims: [{claims}])]"
    );
    let cases = [
        format!("(title: \"x\", arms: [{}], {table})", arms(0, 6_000)),
        format!("(title: \"x\", arms: [{}], {table})", arms(0, 200)),
        format!("(title: \"x\", arms: [(name: \"a\", stages: [{}])], {table})", stage.repeat(8_000)),
        fill("(title: \"x\", arms: [(name: \"a\", stages: [", stage, "])])"),
        fill("(title: \"x\", arms: [], conditions: [", "(name: \"c\"),", "])"),
        format!("(title: \"x\", seeds: 1000, arms: [{}], {table})", arms(0, 100)),
    ];
    for (number, text) in cases.iter().enumerate() {
        assert!(!reads(&format!("long experiment {number}"), untrusted_input::experiment, text.as_bytes()));
    }
    let fast = fs::read_to_string(project("assets/presets/fast.ron")).expect("it is there");
    let hidden = fast.replacen("hidden: [", &format!("hidden: [{}", "9,".repeat(300_000)), 1);
    assert_ne!(hidden, fast);
    assert!(!reads("a long network", untrusted_input::preset, hidden.as_bytes()));
    assert!(!reads("a long text", untrusted_input::preset, fill("(about: \"", "a", "\")").as_bytes()));
}

/// A scenario of few bytes that asks for as much work as it may.
#[test]
fn a_kilobyte_cannot_take_a_second() {
    let zigzag: String =
        (0..62).map(|k| format!("({}, {}),", k * 16 - 480, if k % 2 == 0 { 499 } else { -480 })).collect();
    let spikes = format!("enclosure: Polygon(corners_m: [{zigzag}(499, -499), (-499, -499)])");
    let waypoints: String = (0..100).map(|k| format!("({},{}),", k % 7, k % 5)).collect();
    let patrol = format!(
        "obstacles: [(shape: Circle(radius_m: 0.1), position_m: (0, 0), motion: Patrol(waypoints_m: [{waypoints}], \
         speed_m_s: 0.1))]"
    );
    let big = "enclosure: Rectangle(width_m: 1000, height_m: 1000)";
    let walk = "(shape: Circle(radius_m: 0.01), position_m: (1, 1), motion: RandomWalk(radius_m: 0.01, speed_m_s: 0.5, seed: 7)),";
    let generator = "(count: 200, shape: Rectangle(width_m: (0.5, 0.6), height_m: (0.5, 0.6)), gap_m: 300)";
    let tiny = "robot: (radius_m: 0.01), task: (collision_range_m: 0.011, control_period_s: 0.001, max_episode_steps: 1000000, \
                goal_radius_m: 0.001, min_goal_distance_m: 900), lidar: (beams: 4096, latency_steps: 50)";
    for fields in [
        big.to_string(),
        format!("{big}, {tiny}"),
        format!("{big}, {tiny}, generators: [{generator}]"),
        format!("{big}, {tiny}, obstacles: [{}]", walk.repeat(8)),
        format!("{spikes}, {tiny}"),
        format!("{spikes}, {patrol}"),
        format!("{patrol}, {tiny}"),
        format!("enclosure: Rectangle(width_m: 40, height_m: 40), {tiny}"),
        "enclosure: Rectangle(width_m: 1000, height_m: 0.5), robot: (radius_m: 0.01), task: (collision_range_m: 0.02)".into(),
        "enclosure: Rectangle(width_m: 4, height_m: 4), starts: Random(clearance_m: 1.99), goals: Random(clearance_m: 1.99)".into(),
        "lidar: (beams: 18446744073709551615)".into(),
        "generators: [(count: 4294967295, shape: Circle(radius_m: (0.1, 0.1)))]".into(),
        "task: (control_period_s: 1e-45)".into(),
        "task: (max_episode_steps: 4294967295)".into(),
        "obstacles: [(shape: Circle(radius_m: 0.1), position_m: (1, 1), motion: Orbit(centre_m: (0, 0), speed_rad_s: 1e38))]".into(),
    ] {
        let text = format!("(name: \"x\", benchmark_route: (start_m: (-1, -1), goal_m: (1.2, 1.2)), {fields})");
        reads(&fields, untrusted_input::scenario, text.as_bytes());
    }
    let fast = fs::read_to_string(project("assets/presets/fast.ron")).expect("it is there");
    for (field, value) in [
        ("hidden:", "hidden: [4096, 4096, 4096, 4096, 4096, 4096, 4096, 4096]"),
        ("capacity:", "capacity: 18446744073709551615"),
        ("capacity:", "capacity: 16777216"),
        ("batch_size:", "batch_size: 65536"),
        ("arenas:", "arenas: 4096"),
        ("arenas:", "arenas: 4097"),
        ("n_step:", "n_step: 100"),
        ("gradient_steps:", "gradient_steps: 10000"),
        ("gradient_steps:", "gradient_steps: 4294967295"),
        ("budget:", "budget: EnvSteps(18446744073709551615)"),
    ] {
        let start = fast.find(field).unwrap_or_else(|| panic!("{field} is in fast.ron"));
        let end = start + value_end(&fast[start..]);
        let text = format!("{}{value}{}", &fast[..start], &fast[end..]);
        reads(value, untrusted_input::preset, text.as_bytes());
    }
    let twice = with(&fast, "arenas: 1,");
    assert!(!reads("a key twice", untrusted_input::preset, twice.as_bytes()));
}

/// Where the field at the start of `text` ends: at a comma or bracket outside its own brackets.
fn value_end(text: &str) -> usize {
    let mut depth = 0;
    for (at, c) in text.char_indices() {
        match c {
            '(' | '[' => depth += 1,
            ',' if depth == 0 => return at,
            ')' | ']' if depth == 0 => return at,
            ')' | ']' => depth -= 1,
            _ => {}
        }
    }
    text.len()
}
