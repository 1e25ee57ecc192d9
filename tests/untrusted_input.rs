//! Untrusted input: any file is accepted or rejected quickly, with little memory and without a panic. The
//! fuzzers in `fuzz/` use the same readers.

#[path = "support/untrusted_input.rs"]
mod untrusted_input;

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use wayfield::learning::{Activation, NetworkConfig, QNetwork};
use wayfield::random::{Stream, stream, uniform_index};
use wayfield::run::checkpoint::TrainerState;
use wayfield::run::folder::RunConfig;
use wayfield::run::policy_card;

/// A reader for files of one kind. It returns whether the bytes are valid.
type Reader = fn(&[u8]) -> bool;

const KINDS: [(&str, Reader); 9] = [
    ("policy", untrusted_input::policy),
    ("checkpoint", untrusted_input::checkpoint),
    ("scenario", untrusted_input::scenario),
    ("level_generator", untrusted_input::level_generator),
    ("preset", untrusted_input::preset),
    ("experiment", untrusted_input::experiment),
    ("map", untrusted_input::map),
    ("sdf", untrusted_input::sdf),
    ("barn", untrusted_input::barn),
];
/// Maximum time to read one file.
const MAX_TIME: Duration = Duration::from_secs(if cfg!(debug_assertions) { 20 } else { 1 });
/// Maximum peak memory of this process in kB, over all tests.
const MAX_PEAK_KB: u64 = 400_000;

/// Runs `reader` on `bytes`, checks its time and the peak memory of the process, and returns whether the
/// bytes are valid.
fn check_read(what: &str, reader: Reader, bytes: &[u8]) -> bool {
    let (start, cpu_start) = (Instant::now(), thread_cpu_time());
    let is_valid = reader(bytes);
    let took = match (cpu_start, thread_cpu_time()) {
        (Some(from), Some(to)) => to.saturating_sub(from),
        _ => start.elapsed(),
    };
    assert!(took < MAX_TIME, "{what}: took {took:?}");
    if let Some(peak) = peak_kb() {
        assert!(peak < MAX_PEAK_KB, "{what}: the process has used {peak} kB");
    }
    is_valid
}

/// The CPU time of this thread, where the system reports it. Unlike wall time it does not depend on other
/// processes.
fn thread_cpu_time() -> Option<Duration> {
    let status = fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    Some(Duration::from_nanos(status.split_whitespace().next()?.parse().ok()?))
}

/// The peak memory of this process in kB, where the system reports it.
fn peak_kb() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    line.split_whitespace().nth(1)?.parse().ok()
}

fn project(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// The files in a folder of the project, sorted by name.
fn files(folder: &str) -> Vec<(String, Vec<u8>)> {
    let entries = fs::read_dir(project(folder)).unwrap_or_else(|error| panic!("{folder}: {error}"));
    let mut paths: Vec<_> = entries.map(|entry| entry.expect("a readable entry").path()).collect();
    paths.retain(|path| path.is_file());
    paths.sort();
    let read = |path: PathBuf| (path.display().to_string(), fs::read(&path).expect("a readable file"));
    paths.into_iter().map(read).collect()
}

/// A policy file with a small network, of format version 1.
fn small_policy(dueling: bool) -> Vec<u8> {
    let network =
        NetworkConfig { hidden: vec![2], dueling, layer_norm: !dueling, activation: Activation::Silu };
    let shape = network.shape(2, 2).expect("a valid shape");
    let network = QNetwork::new(shape, &mut stream(1, "weights", 0)).expect("a valid shape");
    let mut policy = network.to_policy();
    policy.metadata =
        [("encoding", "raw"), ("scenario", "x")].map(|(key, value)| (key.into(), value.into())).into();
    policy.to_bytes().expect("finite weights")
}

/// A policy file with a card.
fn policy_with_card() -> Vec<u8> {
    let mut config = RunConfig::resolve("empty", "fast", 1).expect("shipped");
    config.scenario.lidar.beams = 2;
    config.scenario.robot.motions.truncate(2);
    let network = NetworkConfig { hidden: vec![2], ..NetworkConfig::default() };
    let shape = network.shape(6, 2).expect("a valid shape");
    let network = QNetwork::new(shape, &mut stream(1, "weights", 0)).expect("a valid shape");
    let mut policy = network.to_policy();
    policy_card::attach(&mut policy, &config, (1, 2), Some(0.5));
    policy.to_bytes().expect("a valid card")
}

/// `policy` in the framed form, in which the length of the header is always valid.
fn framed(policy: &[u8]) -> Vec<u8> {
    [b"S", &policy[..2], &policy[8..]].concat()
}

/// Valid files of each kind, from which mutations start.
fn seeds(kind: &str) -> Vec<(String, Vec<u8>)> {
    match kind {
        "policy" => {
            let all = [small_policy(false), small_policy(true), policy_with_card()];
            let framed = all.each_ref().map(|policy| framed(policy));
            all.into_iter()
                .chain(framed)
                .enumerate()
                .map(|(k, bytes)| (format!("small-{k}"), bytes))
                .collect()
        }
        "checkpoint" => {
            let after = |steps| (format!("after-{steps}"), untrusted_input::valid_checkpoint(steps));
            [0, 3, 30].map(after).into()
        }
        "scenario" => files("scenarios").into_iter().chain([everything()]).collect(),
        "level_generator" => files("scenarios/generators"),
        "preset" => files("assets/presets"),
        "map" => files("crates/import/tests/fixtures/maps").chunks(2).map(framed_map).collect(),
        "sdf" => files("crates/import/tests/fixtures/sdf"),
        "barn" => files("crates/import/tests/fixtures/barn"),
        _ => files("assets/experiments"),
    }
}

/// The description and the image of a map, whose files are neighbours, in the form that the reader takes.
fn framed_map(files: &[(String, Vec<u8>)]) -> (String, Vec<u8>) {
    let [(_, image), (name, yaml)] = files else { panic!("an image and a description") };
    (name.clone(), [&(yaml.len() as u16).to_le_bytes()[..], yaml, image].concat())
}

/// A scenario that uses most parts of the format.
fn everything() -> (String, Vec<u8>) {
    (
        "everything".into(),
        fs::read(project("crates/scenario/tests/fixtures/everything.ron")).expect("the fixture exists"),
    )
}

#[test]
fn valid_files_are_accepted_and_used() {
    for (kind, reader) in KINDS {
        let seeds = seeds(kind);
        assert!(seeds.len() >= 3, "{kind}");
        for (name, bytes) in &seeds {
            assert!(check_read(name, reader, bytes), "{kind} {name} is valid");
        }
        // Writes the seed corpus of the fuzzers (see fuzz/README.md).
        if let Some(folder) = std::env::var_os("WAYFIELD_FUZZ_SEEDS") {
            let folder = Path::new(&folder).join(kind);
            fs::create_dir_all(&folder).expect("a folder for the seeds");
            for (name, bytes) in seeds {
                let name = Path::new(&name).file_name().expect("a name");
                fs::write(folder.join(name), bytes).expect("a writable folder");
            }
        }
    }
}

/// The name of a defect, and the change to a valid state that causes it.
type Defect = (&'static str, fn(&mut TrainerState));

#[test]
fn a_checkpoint_with_an_impossible_value_is_rejected() {
    let valid = untrusted_input::valid_checkpoint(3);
    let length = usize::from(u16::from_le_bytes([valid[0], valid[1]]));
    let trainer_state: TrainerState = postcard::from_bytes(&valid[4..4 + length]).expect("a valid head");
    let with = |trainer_state: &TrainerState| {
        let head = postcard::to_allocvec(trainer_state).expect("a head");
        [&(head.len() as u16).to_le_bytes(), &valid[2..4], &head, &valid[4 + length..]].concat()
    };
    assert!(untrusted_input::checkpoint(&with(&trainer_state)), "unchanged");
    let defects: &[Defect] = &[
        ("a non-finite pose", |s| s.arenas[0].pose.x_m = f32::NAN),
        ("a robot far outside the enclosure", |s| s.arenas[1].pose.y_m = 1e30),
        ("a clock at its maximum", |s| s.arenas[0].clock.0 = u64::MAX),
        ("a scan without beams", |s| s.arenas[0].scan.ranges_m.clear()),
        ("a scan with too many beams", |s| s.arenas[0].scan.ranges_m.push(1.0)),
        ("a delayed scan without beams", |s| s.arenas[0].scan.delayed[0].1.clear()),
        ("an episode beyond the maximum length", |s| s.arenas[0].episode.steps = u32::MAX),
        ("an inactive arena", |s| s.arenas[0].episode.inactive = true),
        ("one arena too few", |s| s.arenas.truncate(1)),
        ("one stream too few", |s| s.exploration.truncate(1)),
        ("a non-finite last row", |s| s.means = Some((f64::NAN, 0.0, 0.0))),
        ("a non-finite return", |s| s.recent_returns.push_back(f64::INFINITY)),
        ("too many recent returns", |s| s.recent_returns.resize(101, 0.0)),
        ("a next evaluation beyond all budgets", |s| s.next_evaluation = u64::MAX),
        ("a success rate above 1", |s| s.last_success_rate = Some(1.5)),
        ("a truncated best policy", |s| s.best.as_mut().expect("a best policy").bytes.truncate(100)),
        ("a non-finite wall time", |s| s.wall_s = f64::NAN),
        ("non-finite sums", |s| s.stats.loss = f64::NAN),
    ];
    for (name, add_defect) in defects {
        let mut invalid = trainer_state.clone();
        add_defect(&mut invalid);
        assert!(!untrusted_input::checkpoint(&with(&invalid)), "{name}");
    }
}

#[test]
fn files_found_by_fuzzing_no_longer_panic() {
    for (kind, reader) in KINDS {
        for (name, bytes) in files(&format!("tests/fixtures/untrusted_input/{kind}")) {
            check_read(&name, reader, &bytes);
        }
    }
}

/// Extreme numbers, with which mutations replace others.
const EXTREME_NUMBERS: [&str; 16] = [
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

/// `bytes` with one to three random changes.
fn mutated(bytes: &[u8], text: bool, random: &mut Stream) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..1 + uniform_index(random, 3) {
        let at = uniform_index(random, bytes.len().max(1));
        let to = (at + 1 + uniform_index(random, 40)).min(bytes.len());
        match uniform_index(random, 6) {
            0 => drop(bytes.drain(at.min(to)..to)),
            1 => {
                let piece = bytes[at.min(to)..to].to_vec();
                let target = uniform_index(random, bytes.len() + 1);
                bytes.splice(target..target, piece);
            }
            2 if !bytes.is_empty() => bytes[at] = uniform_index(random, 256) as u8,
            3 if !bytes.is_empty() => bytes[at] ^= 1 << uniform_index(random, 8),
            _ if text => {
                // Replaces the first number from here on.
                let digit = |byte: &u8| byte.is_ascii_digit() || matches!(byte, b'-' | b'.');
                let Some(start) = bytes[at.min(to)..].iter().position(digit).map(|k| k + at) else {
                    continue;
                };
                let end = start + bytes[start..].iter().take_while(|byte| digit(byte)).count();
                bytes.splice(
                    start..end,
                    EXTREME_NUMBERS[uniform_index(random, EXTREME_NUMBERS.len())].bytes(),
                );
            }
            _ => {
                let extreme = [0_u8, 0xFF, 0x7F, 0x80][uniform_index(random, 4)];
                let end = (at + 4).min(bytes.len());
                bytes[at.min(end)..end].fill(extreme);
            }
        }
    }
    bytes
}

#[test]
fn mutated_valid_files_never_panic() {
    for (kind, reader) in KINDS {
        let (mut random, mut valid) = (stream(20, kind, 0), 0);
        let seeds = seeds(kind);
        let text = !matches!(kind, "policy" | "checkpoint");
        let each = 1_500 / seeds.len();
        for (name, bytes) in &seeds {
            for number in 0..each {
                let changed = mutated(bytes, text, &mut random);
                valid += usize::from(check_read(&format!("{name}, change {number}"), reader, &changed));
            }
        }
        assert!(
            (20..1_400).contains(&valid),
            "{kind}: {valid} of 1,500 are still valid; the mutations should reach both the checks and the code behind them"
        );
    }
}

/// The kinds of files that are text or, like maps, contain text.
fn texts() -> impl Iterator<Item = (&'static str, Reader)> {
    KINDS.into_iter().filter(|(kind, _)| !matches!(*kind, "policy" | "checkpoint"))
}

const MIB: usize = 1 << 20;

#[test]
fn a_mebibyte_of_repeated_text_is_rejected_quickly() {
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
            "level_generator" => "(wall_layouts: [",
            "preset" => "(learning: (network: (hidden: [",
            _ => "(arms: [",
        };
        for start in ["", "(about: \"", list] {
            for piece in pieces {
                let mut text = start.to_string();
                text.push_str(&piece.repeat((MIB - start.len()) / piece.len()));
                let is_valid = check_read(&format!("{kind}: {start}{piece}..."), reader, text.as_bytes());
                assert!(!is_valid, "{kind}: {start}{piece}... is rejected");
            }
        }
    }
}

/// `text` with `field` added at the end of the outermost parentheses.
fn with(text: &str, field: &str) -> String {
    let end = text.rfind(')').expect("a closing parenthesis");
    format!("{} {field} {}", text[..end].trim_end().trim_end_matches(',').to_string() + ",", &text[end..])
}

#[test]
fn long_lists_of_well_formed_values_are_read_or_rejected_quickly() {
    let fill = |head: &str, piece: &str, tail: &str| {
        format!("{head}{}{tail}", piece.repeat((MIB - head.len() - tail.len()) / piece.len()))
    };
    let scenario = "(name: \"x\", benchmark_route: (start_m: (-1.0, -1.0), goal_m: (1.2, 1.2)), ";
    let fixed = "(shape: Circle(radius_m: 0.01), position_m: (0.5, 0.5)),";
    let invalid = "(shape: Circle(radius_m: -1), position_m: (900, nan)),";
    let moving = "(shape: Rectangle(width_m: 0.01, height_m: 0.01), position_m: (0.3, 0.5), motion: RandomWalk(radius_m: \
                   0.1, speed_m_s: 0.1)),";
    let walls = "(corners_m: [(0.5, 0.5), (0.6, 0.5)]),";
    let generator = "(count: 12, shape: Circle(radius_m: (0.01, 0.02))),";
    let cases = [
        fill(&format!("{scenario}obstacles: ["), fixed, "])"),
        fill(&format!("{scenario}obstacles: ["), invalid, "])"),
        fill(&format!("{scenario}obstacles: ["), moving, "])"),
        fill(&format!("{scenario}walls: ["), walls, "])"),
        fill(&format!("{scenario}generators: ["), generator, "])"),
        fill(&format!("{scenario}enclosure: Polygon(corners_m: ["), "(0,1),(1,0),", "]))"),
        fill(&format!("{scenario}robot: (motions: ["), "(v_m_s: 9, w_rad_s: 99),", "]))"),
        fill(&format!("{scenario}starts: OneOf(positions_m: ["), "(0,1),", "]))"),
        fill("(", "nam: 1,", ")"),
        fill("(", "name: \"a\",", ")"),
        format!("{scenario}obstacles: [{}])", moving.repeat(8_000)),
        format!("{scenario}obstacles: [{}])", fixed.repeat(10_000)),
        format!("{scenario}generators: [{}])", generator.repeat(16)),
        format!("{scenario}walls: [{}])", walls.repeat(1_000)),
    ];
    for (number, text) in cases.iter().enumerate() {
        check_read(&format!("long scenario {number}"), untrusted_input::scenario, text.as_bytes());
    }
    let stage = "(scenario: \"empty\", preset: \"fast\", budget: Episodes(18446744073709551615)),";
    let arms = |from: usize, count: usize| -> String {
        (from..from + count).map(|k| format!("(name: \"{k}\", stages: [{stage}]),")).collect()
    };
    let claims =
        "(statement: \"\", measure: Success, better: \"x\", than: \"y\", after: Episodes(7)),".repeat(4_000);
    let table = format!(
        "tables: [(name: \"t\", title: \"t\", show: Measures(measures: [], after: Episodes(1)), claims: [{claims}])]"
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
        assert!(!check_read(
            &format!("long experiment {number}"),
            untrusted_input::experiment,
            text.as_bytes()
        ));
    }
    let fast = fs::read_to_string(project("assets/presets/fast.ron")).expect("the fixture exists");
    let hidden = fast.replacen("hidden: [", &format!("hidden: [{}", "9,".repeat(300_000)), 1);
    assert_ne!(hidden, fast);
    assert!(!check_read("a long network", untrusted_input::preset, hidden.as_bytes()));
    assert!(!check_read("a long text", untrusted_input::preset, fill("(about: \"", "a", "\")").as_bytes()));
}

/// Small files that ask for as much work as the limits allow.
#[test]
fn a_file_of_a_kilobyte_never_takes_a_second() {
    let zigzag: String =
        (0..62).map(|k| format!("({}, {}),", k * 16 - 480, if k % 2 == 0 { 499 } else { -480 })).collect();
    let spikes = format!("enclosure: Polygon(corners_m: [{zigzag}(499, -499), (-499, -499)])");
    let waypoints: String = (0..100).map(|k| format!("({},{}),", k % 7, k % 5)).collect();
    let patrol = format!(
        "obstacles: [(shape: Circle(radius_m: 0.1), position_m: (0, 0), motion: Patrol(waypoints_m: [{waypoints}], \
         speed_m_s: 0.1))]"
    );
    let large = "enclosure: Rectangle(width_m: 1000, height_m: 1000)";
    let walk = "(shape: Circle(radius_m: 0.01), position_m: (1, 1), motion: RandomWalk(radius_m: 0.01, speed_m_s: 0.5, seed: 7)),";
    let generator = "(count: 200, shape: Rectangle(width_m: (0.5, 0.6), height_m: (0.5, 0.6)), gap_m: 300)";
    let demanding = "robot: (radius_m: 0.01), task: (collision_range_m: 0.011, control_period_s: 0.001, max_episode_steps: 1000000, \
                goal_radius_m: 0.001, min_goal_distance_m: 900), lidar: (beams: 4096, latency_steps: 50)";
    for fields in [
        large.to_string(),
        format!("{large}, {demanding}"),
        format!("{large}, {demanding}, generators: [{generator}]"),
        format!("{large}, {demanding}, obstacles: [{}]", walk.repeat(8)),
        format!("{spikes}, {demanding}"),
        format!("{spikes}, {patrol}"),
        format!("{patrol}, {demanding}"),
        format!("enclosure: Rectangle(width_m: 40, height_m: 40), {demanding}"),
        "enclosure: Rectangle(width_m: 1000, height_m: 0.5), robot: (radius_m: 0.01), task: (collision_range_m: 0.02)".into(),
        "enclosure: Rectangle(width_m: 4, height_m: 4), starts: Random(clearance_m: 1.99), goals: Random(clearance_m: 1.99)".into(),
        "lidar: (beams: 18446744073709551615)".into(),
        "generators: [(count: 4294967295, shape: Circle(radius_m: (0.1, 0.1)))]".into(),
        "task: (control_period_s: 1e-45)".into(),
        "task: (max_episode_steps: 4294967295)".into(),
        "obstacles: [(shape: Circle(radius_m: 0.1), position_m: (1, 1), motion: Orbit(centre_m: (0, 0), speed_rad_s: 1e38))]".into(),
    ] {
        let text = format!("(name: \"x\", benchmark_route: (start_m: (-1, -1), goal_m: (1.2, 1.2)), {fields})");
        check_read(&fields, untrusted_input::scenario, text.as_bytes());
    }
    let fast = fs::read_to_string(project("assets/presets/fast.ron")).expect("the fixture exists");
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
        check_read(value, untrusted_input::preset, text.as_bytes());
    }
    let duplicate = with(&fast, "arenas: 1,");
    assert!(!check_read("a duplicate key", untrusted_input::preset, duplicate.as_bytes()));
}

/// The end of the field at the start of `text`: the first comma or bracket outside nested brackets.
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
