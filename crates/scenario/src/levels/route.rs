//! The starts and goals of a level.

use std::f32::consts::FRAC_PI_2;

use glam::{Vec2, vec2};
use wayfield_random::Stream;

use super::draft::Draft;
use super::schema::Route;
use crate::geometry::length;
use crate::placement::draw_start_and_goal;
use crate::schema::{BenchmarkRoute, PlacementRule, Scenario};

/// Number of random routes, the longest of which becomes the benchmark route.
const ROUTES: usize = 4;

impl Route {
    /// The rules for starts and goals in an enclosure of this height.
    pub(super) fn rules(self, height_m: f32) -> (PlacementRule, PlacementRule) {
        match self {
            Self::Random { clearance_m } => {
                (PlacementRule::Random { clearance_m }, PlacementRule::Random { clearance_m })
            }
            Self::Across { margin_m } => {
                let end = vec2(0.0, (height_m - margin_m) / 2.0);
                fixed(-end, FRAC_PI_2, end)
            }
            Self::Fixed { start_m, heading_rad, goal_m } => fixed(start_m, heading_rad, goal_m),
        }
    }
}

fn fixed(start_m: Vec2, heading_rad: f32, goal_m: Vec2) -> (PlacementRule, PlacementRule) {
    let fixed = |position_m, heading_rad| PlacementRule::Fixed { position_m, heading_rad };
    (fixed(start_m, Some(heading_rad)), fixed(goal_m, None))
}

/// Completes the level with a benchmark route, drawn by the rules for starts and goals.
///
/// # Errors
/// The reason why there is no route, as the rest of a sentence.
pub(super) fn add(draft: Draft, stream: &mut Stream) -> Result<Scenario, &'static str> {
    let mut level = draft.scenario;
    let mut longest: Option<((f32, f32, f32), Vec2)> = None;
    let distance = |((x, y, _), goal): ((f32, f32, f32), Vec2)| length(goal.x - x, goal.y - y);
    for _ in 0..ROUTES {
        let route = draw_start_and_goal(&level, 0, stream)
            .map_err(|_| "there is no free space for a start, or no goal far enough from it")?;
        longest = longest.filter(|&other| distance(other) >= distance(route)).or(Some(route));
    }
    level.benchmark_route = longest.map(|((x, y, heading_rad), goal_m)| BenchmarkRoute {
        start_m: vec2(x, y),
        heading_rad,
        goal_m,
    });
    Ok(level)
}
