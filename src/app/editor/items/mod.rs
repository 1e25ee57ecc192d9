//! The items of a scenario that can be selected, one file per kind, all behind the trait [`Editable`].
//!
//! | file | purpose |
//! |---|---|
//! | `editable.rs` | the trait, and the types in its methods |
//! | `enclosure.rs` | the boundary |
//! | `obstacle.rs` | an obstacle; `obstacle_body.rs` its shape, `obstacle_path.rs` its motion |
//! | `wall.rs` | an inner wall |
//! | `generator.rs` | a generator of random obstacles |
//! | `placement_rule.rs` | the rule for starts or goals |
//! | `benchmark_start.rs`, `benchmark_goal.rs` | the ends of the benchmark route |
//! | `corners.rs`, `rectangles.rs` | shared: lists of corners, axis-aligned rectangles |

mod benchmark_goal;
mod benchmark_start;
mod corners;
mod editable;
mod enclosure;
mod generator;
mod obstacle;
mod obstacle_body;
mod obstacle_path;
mod placement_rule;
mod rectangles;
mod wall;

use super::kinds::PlacementRole;
use super::selection::Selection;
use crate::scenario::Scenario;

pub use editable::Body;
pub(super) use editable::{DragTarget, Editable, ListItem};

/// The item that is selected.
pub(super) fn selected(selection: Selection) -> Option<Box<dyn Editable>> {
    Some(match selection {
        Selection::Nothing => return None,
        Selection::Enclosure => Box::new(enclosure::EnclosureItem),
        Selection::Obstacle(index) => Box::new(obstacle::ObstacleItem(index)),
        Selection::Wall(index) => Box::new(wall::WallItem(index)),
        Selection::Generator(index) => Box::new(generator::GeneratorItem(index)),
        Selection::Starts => Box::new(placement_rule::RuleItem(PlacementRole::Starts)),
        Selection::Goals => Box::new(placement_rule::RuleItem(PlacementRole::Goals)),
        Selection::BenchmarkStart => Box::new(benchmark_start::BenchmarkStartItem),
        Selection::BenchmarkGoal => Box::new(benchmark_goal::BenchmarkGoalItem),
    })
}

impl Selection {
    /// The selection itself if `scenario` has the item, else [`Selection::Nothing`].
    #[must_use]
    pub fn if_present(self, scenario: &Scenario) -> Self {
        let exists = selected(self).is_some_and(|item| item.exists(scenario));
        if exists { self } else { Self::Nothing }
    }

    /// The item's name, such as `Obstacle 3 of 4`.
    #[must_use]
    pub fn title(self, scenario: &Scenario) -> String {
        selected(self).map_or_else(|| "Scenario".into(), |item| item.title(scenario))
    }

    /// The item's shape in the plane.
    #[must_use]
    pub fn body(self, scenario: &Scenario) -> Body {
        selected(self).map_or(Body::Nothing, |item| item.body(scenario))
    }
}
