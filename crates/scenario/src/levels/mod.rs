//! Level generators: families of whole scenarios, of which each seed gives one.
//!
//! In: a [`LevelGenerator`], read from a file or built in code, and a seed. Out: a level, which is a [`Scenario`] without
//! generators, the same bit for bit on every platform. Its passages are wide enough for the robot, so that every goal can be
//! reached from every start.
//!
//! | file | purpose |
//! |---|---|
//! | `schema.rs` | the types of the file |
//! | `check.rs` | the checks of a generator |
//! | `draft.rs` | a level under construction: enclosure, bodies, the gaps between them |
//! | `floor.rs` | the free space, and whether goals can be reached |
//! | `walls.rs` | the choice of walls; each layout has a file: `cells.rs`, `text_grid.rs`, `rooms.rs`, `maze.rs`, `traps.rs` |
//! | `blocks.rs` | solid blocks on a grid, for cells, text and mazes |
//! | `automaton.rs`, `scatter.rs` | clutter |
//! | `traffic.rs`, `lanes.rs`, `pedestrians.rs` | moving obstacles |
//! | `route.rs` | starts and goals |

mod automaton;
mod blocks;
mod cells;
mod check;
mod draft;
mod floor;
mod lanes;
mod maze;
mod pedestrians;
mod rooms;
mod route;
mod scatter;
mod schema;
mod text_grid;
mod traffic;
mod traps;
mod walls;

use std::path::Path;

use wayfield_random::{Stream, stream, uniform, uniform_index};

use crate::check::has_valid_space;
use crate::file_error::FileError;
use crate::load::{parse_checked, read_text, resemblance};
use crate::schema::Scenario;
use draft::Draft;

pub use check::level_generator_diagnostics;
pub use schema::{Clutter, LevelGenerator, Route, Traffic, WallLayout};

/// The number of attempts to make a level that the robot can solve. Each has its own random streams.
const ATTEMPTS: u64 = 100;

/// The error when a generator has no level for a seed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "no level of {generator:?} for seed {seed} in {ATTEMPTS} attempts: in the last one, {reason}; help: write a smaller fill, \
     fewer or smaller obstacles, a smaller gap_m, or a larger enclosure"
)]
pub struct LevelError {
    /// Name of the generator.
    pub generator: String,
    /// The seed.
    pub seed: u64,
    /// Why the last attempt failed.
    pub reason: &'static str,
}

impl LevelGenerator {
    /// Reads and checks the generator in the file at `path`.
    ///
    /// # Errors
    /// [`FileError`] if the file can't be read, is not a level generator, or has diagnostics; it lists all of them.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, FileError> {
        let path = path.as_ref();
        Self::parse(&read_text(path)?, path)
    }

    /// Parses and checks the generator in `text`. Errors name `path`.
    ///
    /// # Errors
    /// As [`LevelGenerator::load`].
    pub fn parse(text: &str, path: impl AsRef<Path>) -> Result<Self, FileError> {
        parse_checked(
            text,
            path,
            |generator, _| level_generator_diagnostics(generator),
            level_generator_diagnostics,
        )
    }

    /// Whether `text`, by its fields, is probably a level generator rather than a scenario.
    #[must_use]
    pub fn looks_like(text: &str) -> bool {
        resemblance::<Self>(text, "LevelGenerator") > resemblance::<Scenario>(text, "Scenario")
    }

    /// The level for `seed`. The same seed gives the same level. The generator must have no diagnostics.
    ///
    /// # Errors
    /// [`LevelError`] if no level that the robot can solve is found, because the parameters leave too little space.
    pub fn level(&self, seed: u64) -> Result<Scenario, LevelError> {
        let mut reason = "";
        for attempt in 0..ATTEMPTS {
            match self.attempt(&Streams { seed, attempt }) {
                Ok(level) => return Ok(level),
                Err(why) => reason = why,
            }
        }
        Err(LevelError { generator: self.name.clone(), seed, reason })
    }

    /// Makes a level, or gives the reason why the robot can't solve it.
    fn attempt(&self, streams: &Streams) -> Result<Scenario, &'static str> {
        let mut draft = Draft::new(self, &mut streams.named("levels: size"), streams.seed);
        walls::add(&mut draft, &self.wall_layouts, &mut streams.named("levels: walls"));
        let mut stream = streams.named("levels: clutter");
        match one_of(&self.clutter, &mut stream) {
            Some(Clutter::Automaton { fill, smoothings, cell_m }) => {
                automaton::add(&mut draft, *fill, *smoothings, *cell_m, &mut stream);
            }
            Some(Clutter::Scatter { count, shapes }) => scatter::add(&mut draft, *count, shapes, &mut stream),
            None => {}
        }
        draft.floor().check()?;
        traffic::add(&mut draft, &self.traffic, &mut streams.named("levels: traffic"));
        let level = route::add(draft, &mut streams.named("levels: route"))?;
        if has_valid_space(&level) {
            Ok(level)
        } else {
            Err("there is too little free space for starts and goals")
        }
    }
}

/// The random streams of an attempt.
struct Streams {
    seed: u64,
    attempt: u64,
}

impl Streams {
    fn named(&self, name: &str) -> Stream {
        stream(self.seed, name, self.attempt)
    }
}

/// An element of `list`, all with equal probability; `None` if it is empty.
fn one_of<'a, T>(list: &'a [T], stream: &mut Stream) -> Option<&'a T> {
    if list.is_empty() { None } else { list.get(uniform_index(stream, list.len())) }
}

/// A uniform draw from a range.
fn number(stream: &mut Stream, (low, high): (f32, f32)) -> f32 {
    uniform(stream, low, high)
}

/// A uniform draw from a range of whole numbers, both ends included.
fn whole(stream: &mut Stream, (low, high): (u32, u32)) -> u32 {
    low + uniform_index(stream, high.saturating_sub(low) as usize + 1) as u32
}
