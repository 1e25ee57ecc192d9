//! Level generators: every level is a valid scenario that the robot can solve, and depends on its seed alone.

use wayfield_scenario::{LevelGenerator, Scenario, diagnostics, to_text};

/// Seeds of each generator that are tested.
const SEEDS: u64 = 200;

fn generator(text: &str) -> LevelGenerator {
    LevelGenerator::parse(text, "test.ron").unwrap_or_else(|error| panic!("{error}"))
}

fn level(generator: &LevelGenerator, seed: u64) -> Scenario {
    generator.level(seed).unwrap_or_else(|error| panic!("{error}"))
}

const AUTOMATON: &str = "(name: \"Automaton\", clutter: [Automaton()])";
const ACROSS: &str =
    "(name: \"Across\", width_m: (4.5, 4.5), height_m: (6.5, 6.5), clutter: [Automaton()], route: Across())";
const SCATTER: &str = "(name: \"Scatter\", clutter: [Scatter(count: (5, 20), shapes: [
    Circle(radius_m: (0.02, 0.2)),
    Rectangle(width_m: (0.2, 0.6), height_m: (0.2, 0.4)),
    Rectangle(width_m: (0.5, 1.5), height_m: (0.03, 0.06)),
])])";

const CELLS: &str = "(name: \"Cells\", walls: [Cells()])";
const ROOMS: &str = "(name: \"Rooms\", walls: [Rooms()])";
const MAZE: &str = "(name: \"Maze\", walls: [Maze()])";
const CORRIDORS: &str = "(name: \"Corridors\", walls: [Maze(wall_m: (0.5, 1.2))])";
const TRAPS: &str = "(name: \"Traps\", walls: [Traps()])";

/// One generator of every layout.
const ALL: [&str; 8] = [AUTOMATON, ACROSS, SCATTER, CELLS, ROOMS, MAZE, CORRIDORS, TRAPS];

#[test]
fn every_level_is_a_valid_scenario() {
    for text in ALL {
        let generator = generator(text);
        for seed in 0..SEEDS {
            let level = level(&generator, seed);
            let found = diagnostics(&level);
            assert!(found.is_empty(), "{}: {found:?}", level.name);
        }
    }
}

#[test]
fn the_same_seed_gives_the_same_file() {
    for text in ALL {
        let generator = generator(text);
        for seed in [0, 1, 1_000_000, u64::MAX] {
            let text = to_text(&level(&generator, seed), None);
            assert_eq!(text, to_text(&level(&generator, seed), None));
            assert_eq!(Scenario::parse(&text, "level.ron").expect("valid"), level(&generator, seed));
        }
        let (one, other) = (level(&generator, 0), level(&generator, 1));
        assert_ne!((one.walls, one.obstacles), (other.walls, other.obstacles));
    }
}

#[test]
#[ignore = "prints times"]
fn time_of_a_level() {
    for text in ALL {
        let generator = generator(text);
        let start = std::time::Instant::now();
        let levels: Vec<_> = (0..SEEDS).map(|seed| level(&generator, seed)).collect();
        let made = start.elapsed();
        levels.iter().for_each(|level| assert!(diagnostics(level).is_empty()));
        let both = start.elapsed();
        let shapes: usize = levels.iter().map(|level| level.obstacles.len()).sum();
        println!(
            "{}: {:?} a level, {:?} its checks, {} shapes",
            generator.name,
            made / SEEDS as u32,
            (both - made) / SEEDS as u32,
            shapes as u64 / SEEDS
        );
    }
}
