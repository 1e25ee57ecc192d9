//! The item under the pointer.

use bevy::math::{Vec2, vec2};

use super::items;
use super::points::distance;
use super::selection::Selection;
use crate::scenario::{Region, Scenario, enclosure_distance, polygon};

/// The item at `point_m`. Small and thin items are hit within `slack_m`. The selected item wins where solid items
/// overlap.
pub(super) fn pick(scenario: &Scenario, selected: Selection, point_m: Vec2, slack_m: f32) -> Selection {
    let mark_radius_m = |of: Selection| match of {
        Selection::Starts | Selection::BenchmarkStart => scenario.robot.reach_m(),
        _ => scenario.task.goal_radius_m,
    };
    // The centre of a start or goal goes first: inside a solid item it could not be picked otherwise.
    mark(scenario, point_m, |_| slack_m)
        .or_else(|| is_solid_at(scenario, selected, point_m, 0.0).then_some(selected))
        .or_else(|| solid(scenario, point_m, 0.0))
        .or_else(|| mark(scenario, point_m, mark_radius_m))
        .or_else(|| solid(scenario, point_m, slack_m))
        .or_else(|| outline(scenario, point_m, slack_m))
        .unwrap_or_default()
}

fn is_solid_at(scenario: &Scenario, selection: Selection, point_m: Vec2, slack_m: f32) -> bool {
    let distance_m = items::selected(selection).and_then(|item| item.solid_distance_m(scenario, point_m));
    distance_m.is_some_and(|away| away <= slack_m)
}

/// The obstacle, else the wall, within `slack_m`; of several, the one drawn last.
fn solid(scenario: &Scenario, point_m: Vec2, slack_m: f32) -> Option<Selection> {
    let obstacles = (0..scenario.obstacles.len()).rev().map(Selection::Obstacle);
    let mut solids = obstacles.chain((0..scenario.walls.len()).rev().map(Selection::Wall));
    solids.find(|&selection| is_solid_at(scenario, selection, point_m, slack_m))
}

/// The nearest start or goal whose centre is within `reach_m`.
fn mark(scenario: &Scenario, point_m: Vec2, reach_m: impl Fn(Selection) -> f32) -> Option<Selection> {
    let ends = scenario.benchmark_route.iter().flat_map(|route| {
        [(route.start_m, Selection::BenchmarkStart), (route.goal_m, Selection::BenchmarkGoal)]
    });
    let rules = [(&scenario.starts, Selection::Starts), (&scenario.goals, Selection::Goals)];
    let named =
        rules.into_iter().flat_map(|(rule, of)| rule.positions_m().iter().map(move |&place| (place, of)));
    ends.chain(named)
        .map(|(place, of)| (distance(place, point_m), of))
        .filter(|&(away, of)| away <= reach_m(of))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, of)| of)
}

/// The region whose outline is within `slack_m`, else the enclosure.
fn outline(scenario: &Scenario, point_m: Vec2, slack_m: f32) -> Option<Selection> {
    let generators = scenario.generators.iter().enumerate();
    let generators = generators.map(|(k, generator)| (generator.within, Selection::Generator(k)));
    let rules = [(&scenario.starts, Selection::Starts), (&scenario.goals, Selection::Goals)];
    let hit = |region: Region| outline_distance(region, point_m) <= slack_m;
    let found = generators
        .chain(rules.map(|(rule, of)| (rule.region(), of)))
        .find(|(region, _)| region.is_some_and(hit));
    let on_boundary = || enclosure_distance(&scenario.enclosure, point_m).abs() <= slack_m;
    found.map(|(_, of)| of).or_else(|| on_boundary().then_some(Selection::Enclosure))
}

fn outline_distance(Region { min_m, max_m }: Region, point_m: Vec2) -> f32 {
    let corners = [min_m, vec2(max_m.x, min_m.y), max_m, vec2(min_m.x, max_m.y)];
    polygon::sides(&corners)
        .map(|(from, to)| polygon::distance_to_segment(from, to, point_m))
        .fold(f32::INFINITY, f32::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::{
        BenchmarkRoute, Generator, Obstacle, ObstacleMotion, PlacementRule, RandomShape, Shape, Wall,
    };

    fn crowded() -> Scenario {
        let disc = |position_m, radius_m| Obstacle {
            shape: Shape::Circle { radius_m },
            position_m,
            rotation_rad: 0.0,
            motion: ObstacleMotion::Static,
        };
        Scenario {
            obstacles: vec![disc(vec2(-1.0, 0.0), 0.3), disc(vec2(-0.8, 0.0), 0.3)],
            walls: vec![Wall {
                corners_m: vec![vec2(0.0, -1.5), vec2(1.0, -1.5)],
                thickness_m: 0.1,
                ..Wall::default()
            }],
            generators: vec![Generator {
                count: 1,
                shape: RandomShape::Circle { radius_m: (0.1, 0.2) },
                gap_m: 0.4,
                within: Some(Region { min_m: vec2(0.0, 0.5), max_m: vec2(1.0, 1.0) }),
            }],
            goals: PlacementRule::OneOf { positions_m: vec![vec2(1.5, 0.0), vec2(1.5, -1.0)] },
            benchmark_route: Some(BenchmarkRoute::default()),
            ..Scenario::default()
        }
    }

    #[test]
    fn the_item_under_the_pointer_is_picked() {
        let scenario = crowded();
        let pick = |selected, at| super::pick(&scenario, selected, at, 0.03);
        let none = Selection::Nothing;
        assert_eq!(pick(none, vec2(-0.9, 0.0)), Selection::Obstacle(1), "the one drawn last");
        assert_eq!(pick(Selection::Obstacle(0), vec2(-0.9, 0.0)), Selection::Obstacle(0), "the selected one");
        assert_eq!(pick(Selection::Obstacle(0), vec2(-0.55, 0.0)), Selection::Obstacle(1), "no overlap here");
        assert_eq!(pick(none, vec2(-1.32, 0.0)), Selection::Obstacle(0), "2 cm off");
        assert_eq!(pick(none, vec2(-1.34, 0.0)), none);
        assert_eq!(pick(none, vec2(0.5, -1.47)), Selection::Wall(0));
        assert_eq!(pick(none, vec2(0.5, 0.52)), Selection::Generator(0), "on the outline of its region");
        assert_eq!(pick(none, vec2(0.5, 0.7)), none, "a region is hit only on its outline");
        assert_eq!(pick(none, vec2(1.6, -1.0)), Selection::Goals, "within the goal radius");
        assert_eq!(pick(none, vec2(0.05, 0.0)), Selection::BenchmarkStart);
        assert_eq!(pick(none, vec2(1.21, 1.19)), Selection::BenchmarkGoal);
        assert_eq!(pick(none, vec2(1.98, 0.7)), Selection::Enclosure);
        assert_eq!(pick(none, vec2(2.02, 0.7)), Selection::Enclosure);
    }

    #[test]
    fn a_mark_inside_an_obstacle_can_be_picked() {
        let mut scenario = crowded();
        scenario.benchmark_route =
            Some(BenchmarkRoute { start_m: vec2(-1.0, 0.0), ..BenchmarkRoute::default() });
        let pick = |at| super::pick(&scenario, Selection::Obstacle(0), at, 0.03);
        assert_eq!(pick(vec2(-1.0, 0.01)), Selection::BenchmarkStart);
        assert_eq!(pick(vec2(-1.0, 0.05)), Selection::Obstacle(0));
    }

    #[test]
    fn a_selection_without_an_item_becomes_nothing() {
        let scenario = crowded();
        assert_eq!(Selection::Obstacle(1).if_present(&scenario), Selection::Obstacle(1));
        for missing in [Selection::Obstacle(2), Selection::Wall(1), Selection::Generator(1)] {
            assert_eq!(missing.if_present(&scenario), Selection::Nothing);
        }
    }
}
