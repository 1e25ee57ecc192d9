//! What can be selected, what is under the pointer, and what a finding is about.
//!
//! In: a scenario, a point or a field's path. Out: a [`Selection`].

use super::points::distance;
use crate::scenario::{
    Obstacle, PlacementRule, Region, Scenario, enclosure_distance, inner_wall_distance, polygon,
    shape_distance,
};
use bevy::math::{Vec2, vec2};

/// What the handles and the inspector are of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Selection {
    /// None of the things in the world: the inspector shows the world's own numbers.
    #[default]
    Nothing,
    /// The walls around.
    Enclosure,
    /// An obstacle, by its place in the list.
    Obstacle(usize),
    /// An inner wall.
    Wall(usize),
    /// What draws obstacles anew for every episode.
    Generator(usize),
    /// The rule of starts.
    Starts,
    /// The rule of goals.
    Goals,
    /// The benchmark route's start.
    BenchmarkStart,
    /// The benchmark route's goal.
    BenchmarkGoal,
}

impl Selection {
    /// What the field at `path`, as a finding has it, belongs to.
    #[must_use]
    pub fn from_field_path(path: &str) -> Self {
        let end = path.find(['.', '[']).unwrap_or(path.len());
        let (head, rest) = path.split_at(end);
        let index = || rest.strip_prefix('[')?.split(']').next()?.parse().ok();
        let listed = |of: fn(usize) -> Self| index().map_or(Self::Nothing, of);
        match head {
            "enclosure" => Self::Enclosure,
            "obstacles" => listed(Self::Obstacle),
            "walls" => listed(Self::Wall),
            "generators" => listed(Self::Generator),
            "starts" => Self::Starts,
            "goals" => Self::Goals,
            "benchmark_route" if rest.starts_with(".goal") => Self::BenchmarkGoal,
            "benchmark_route" => Self::BenchmarkStart,
            _ => Self::Nothing,
        }
    }

    /// Itself if `scenario` has such a thing, else nothing.
    #[must_use]
    pub fn if_present(self, scenario: &Scenario) -> Self {
        let there = match self {
            Self::Obstacle(k) => k < scenario.obstacles.len(),
            Self::Wall(k) => k < scenario.walls.len(),
            Self::Generator(k) => k < scenario.generators.len(),
            _ => true,
        };
        if there { self } else { Self::Nothing }
    }
}

/// The fixed places of a rule.
pub(super) fn places(rule: &PlacementRule) -> &[Vec2] {
    match rule {
        PlacementRule::Fixed { position_m, .. } => std::slice::from_ref(position_m),
        PlacementRule::OneOf { positions_m } => positions_m,
        PlacementRule::Random { .. } | PlacementRule::Within { .. } => &[],
    }
}

/// The rectangle of a rule.
pub(super) fn region(rule: &PlacementRule) -> Option<Region> {
    match *rule {
        PlacementRule::Within { min_m, max_m, .. } => Some(Region { min_m, max_m }),
        _ => None,
    }
}

/// What is under `position_m`, with so much slack in m for what is small or thin. `now`, what is selected, wins where solid
/// things overlap.
pub(super) fn pick(scenario: &Scenario, now: Selection, at: Vec2, slack_m: f32) -> Selection {
    let obstacle = |k: usize| scenario.obstacles.get(k).map(|obstacle| from_obstacle(obstacle, at));
    let wall = |k: usize| scenario.walls.get(k).map(|wall| inner_wall_distance(wall, at));
    // A mark inside a solid thing could not be reached otherwise.
    if let Some(mark) = mark(scenario, at, |_| slack_m) {
        return mark;
    }
    let still = match now {
        Selection::Obstacle(k) => obstacle(k),
        Selection::Wall(k) => wall(k),
        _ => None,
    };
    if still.is_some_and(|away| away <= 0.0) {
        return now;
    }
    for slack_m in [0.0, slack_m] {
        // Of those that overlap the one that is drawn last.
        let hit = |away: Option<f32>| away.is_some_and(|away| away <= slack_m);
        if let Some(k) = (0..scenario.obstacles.len()).rev().find(|&k| hit(obstacle(k))) {
            return Selection::Obstacle(k);
        }
        if let Some(k) = (0..scenario.walls.len()).rev().find(|&k| hit(wall(k))) {
            return Selection::Wall(k);
        }
        if slack_m == 0.0
            && let Some(mark) = mark(scenario, at, |of| match of {
                Selection::Starts | Selection::BenchmarkStart => scenario.robot.radius_m,
                _ => scenario.task.goal_radius_m,
            })
        {
            return mark;
        }
    }
    frame(scenario, at, slack_m).unwrap_or_else(|| {
        let on = enclosure_distance(&scenario.enclosure, at).abs() <= slack_m;
        if on { Selection::Enclosure } else { Selection::Nothing }
    })
}

fn from_obstacle(obstacle: &Obstacle, at: Vec2) -> f32 {
    let Vec2 { x, y } = obstacle.position_m;
    shape_distance(&obstacle.shape, (x, y, obstacle.rotation_rad), at)
}

/// The nearest mark of a start or a goal within `reach_m` of what it is.
fn mark(scenario: &Scenario, at: Vec2, reach_m: impl Fn(Selection) -> f32) -> Option<Selection> {
    let benchmark_route = &scenario.benchmark_route;
    let fixed = |rule, of| places(rule).iter().map(move |&place| (place, of));
    let marks = [
        (benchmark_route.start_m, Selection::BenchmarkStart),
        (benchmark_route.goal_m, Selection::BenchmarkGoal),
    ];
    marks
        .into_iter()
        .chain(fixed(&scenario.starts, Selection::Starts))
        .chain(fixed(&scenario.goals, Selection::Goals))
        .map(|(place, of)| (distance(place, at), of))
        .filter(|&(away, of)| away <= reach_m(of))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, of)| of)
}

/// A rectangle of a rule or of a generator whose outline is there.
fn frame(scenario: &Scenario, at: Vec2, slack_m: f32) -> Option<Selection> {
    let generators = scenario.generators.iter().enumerate();
    let generators = generators.map(|(k, generator)| (generator.within, Selection::Generator(k)));
    let rules = [(&scenario.starts, Selection::Starts), (&scenario.goals, Selection::Goals)];
    generators
        .chain(rules.map(|(rule, of)| (region(rule), of)))
        .find(|(region, _)| region.is_some_and(|region| from_outline(region, at) <= slack_m))
        .map(|(_, of)| of)
}

fn from_outline(Region { min_m, max_m }: Region, at: Vec2) -> f32 {
    let corners = [min_m, vec2(max_m.x, min_m.y), max_m, vec2(min_m.x, max_m.y)];
    polygon::sides(&corners)
        .map(|(from, to)| polygon::distance_to_segment(from, to, at))
        .fold(f32::INFINITY, f32::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::{Generator, ObstacleMotion, RandomShape, Shape, Wall};

    fn crowded() -> Scenario {
        let disc = |position_m, radius_m| Obstacle {
            shape: Shape::Circle { radius_m },
            position_m,
            rotation_rad: 0.0,
            motion: ObstacleMotion::Static,
        };
        Scenario {
            obstacles: vec![disc(vec2(-1.0, 0.0), 0.3), disc(vec2(-0.8, 0.0), 0.3)],
            walls: vec![Wall { corners_m: vec![vec2(0.0, -1.5), vec2(1.0, -1.5)], thickness_m: 0.1 }],
            generators: vec![Generator {
                count: 1,
                shape: RandomShape::Circle { radius_m: (0.1, 0.2) },
                gap_m: 0.4,
                within: Some(Region { min_m: vec2(0.0, 0.5), max_m: vec2(1.0, 1.0) }),
            }],
            goals: PlacementRule::OneOf { positions_m: vec![vec2(1.5, 0.0), vec2(1.5, -1.0)] },
            ..Scenario::default()
        }
    }

    #[test]
    fn what_is_under_the_pointer_is_found() {
        let scenario = crowded();
        let pick = |now, at| super::pick(&scenario, now, at, 0.03);
        let none = Selection::Nothing;
        assert_eq!(pick(none, vec2(-0.9, 0.0)), Selection::Obstacle(1), "the one drawn last");
        assert_eq!(
            pick(Selection::Obstacle(0), vec2(-0.9, 0.0)),
            Selection::Obstacle(0),
            "or the selected one"
        );
        assert_eq!(
            pick(Selection::Obstacle(0), vec2(-0.55, 0.0)),
            Selection::Obstacle(1),
            "not where it isn't"
        );
        assert_eq!(pick(none, vec2(-1.32, 0.0)), Selection::Obstacle(0), "2 cm beside it");
        assert_eq!(pick(none, vec2(-1.34, 0.0)), none);
        assert_eq!(pick(none, vec2(0.5, -1.47)), Selection::Wall(0));
        assert_eq!(pick(none, vec2(0.5, 0.52)), Selection::Generator(0), "its region's outline");
        assert_eq!(pick(none, vec2(0.5, 0.7)), none, "a region is empty within");
        assert_eq!(pick(none, vec2(1.6, -1.0)), Selection::Goals, "within the goal radius");
        assert_eq!(pick(none, vec2(0.05, 0.0)), Selection::BenchmarkStart);
        assert_eq!(pick(none, vec2(1.21, 1.19)), Selection::BenchmarkGoal);
        assert_eq!(pick(none, vec2(1.98, 0.7)), Selection::Enclosure);
        assert_eq!(pick(none, vec2(2.02, 0.7)), Selection::Enclosure);
    }

    #[test]
    fn a_mark_inside_an_obstacle_can_be_picked() {
        let mut scenario = crowded();
        scenario.benchmark_route.start_m = vec2(-1.0, 0.0);
        let pick = |at| super::pick(&scenario, Selection::Obstacle(0), at, 0.03);
        assert_eq!(pick(vec2(-1.0, 0.01)), Selection::BenchmarkStart);
        assert_eq!(pick(vec2(-1.0, 0.05)), Selection::Obstacle(0));
    }

    #[test]
    fn a_path_says_what_it_is_about() {
        for (path, expected) in [
            ("obstacles[2].shape.radius_m", Selection::Obstacle(2)),
            ("obstacles", Selection::Nothing),
            ("walls[0].corners_m[3]", Selection::Wall(0)),
            ("generators[1].count", Selection::Generator(1)),
            ("starts.clearance_m", Selection::Starts),
            ("goals", Selection::Goals),
            ("benchmark_route.start_m[0]", Selection::BenchmarkStart),
            ("benchmark_route.goal_m", Selection::BenchmarkGoal),
            ("enclosure.width_m", Selection::Enclosure),
            ("robot.radius_m", Selection::Nothing),
            ("obstacles[x]", Selection::Nothing),
        ] {
            assert_eq!(Selection::from_field_path(path), expected, "{path}");
        }
    }

    #[test]
    fn what_is_not_there_is_nothing() {
        let scenario = crowded();
        assert_eq!(Selection::Obstacle(1).if_present(&scenario), Selection::Obstacle(1));
        for gone in [Selection::Obstacle(2), Selection::Wall(1), Selection::Generator(1)] {
            assert_eq!(gone.if_present(&scenario), Selection::Nothing);
        }
    }
}
