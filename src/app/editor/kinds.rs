//! Another kind: of motion, of the rule of starts or goals, of the enclosure; with numbers that fit the world.
//!
//! In: the kind. Out: the world with it. What the kind before had in common with it is kept.

use super::body::bounding_radius;
use super::handles::middle_of;
use super::items::near;
use super::points::{distance, middle, minus, plus, point_to_mm, to_mm};
use super::selection::{Selection, places};
use super::tools::SPEED_M_S;
use super::{Editor, Snap};
use crate::scenario::{
    Enclosure, Obstacle, ObstacleMotion, PlacementRule, Scenario, clearance, enclosure_distance,
};
use bevy::math::{Vec2, vec2};

/// The speed of a new orbit, in rad/s: the paper's Scenario II has about as much.
const SPEED_RAD_S: f32 = 0.15;
/// The clearance of a new rule, in m, as the schema has it.
const CLEARANCE_M: f32 = 0.35;

/// How an obstacle moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotionKind {
    /// Not at all.
    Static,
    /// Around a point.
    Orbit,
    /// Along a closed path.
    Patrol,
    /// Along a path and back.
    BackAndForth,
    /// At random.
    RandomWalk,
}

impl MotionKind {
    /// All of them.
    pub const ALL: [Self; 5] =
        [Self::Static, Self::Orbit, Self::Patrol, Self::BackAndForth, Self::RandomWalk];

    /// That of a motion.
    #[must_use]
    pub fn from_motion(motion: &ObstacleMotion) -> Self {
        match motion {
            ObstacleMotion::Static => Self::Static,
            ObstacleMotion::Orbit { .. } => Self::Orbit,
            ObstacleMotion::Patrol { .. } => Self::Patrol,
            ObstacleMotion::BackAndForth { .. } => Self::BackAndForth,
            ObstacleMotion::RandomWalk { .. } => Self::RandomWalk,
        }
    }
}

/// Whose rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlacementRole {
    /// Where the robot starts.
    Starts,
    /// Where goals are put.
    Goals,
}

impl PlacementRole {
    /// That of a scenario.
    #[must_use]
    pub fn of(self, scenario: &Scenario) -> &PlacementRule {
        match self {
            Self::Starts => &scenario.starts,
            Self::Goals => &scenario.goals,
        }
    }

    /// The same, to be changed.
    pub fn of_mut(self, scenario: &mut Scenario) -> &mut PlacementRule {
        match self {
            Self::Starts => &mut scenario.starts,
            Self::Goals => &mut scenario.goals,
        }
    }

    /// What is selected when it is.
    #[must_use]
    pub fn selection(self) -> Selection {
        match self {
            Self::Starts => Selection::Starts,
            Self::Goals => Selection::Goals,
        }
    }
}

/// Where starts or goals may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlacementKind {
    /// Anywhere.
    Random,
    /// Anywhere within a rectangle.
    Within,
    /// Always in the same place.
    Fixed,
    /// In one of a few places.
    OneOf,
}

impl PlacementKind {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Random, Self::Within, Self::Fixed, Self::OneOf];

    /// That of a rule.
    #[must_use]
    pub fn from_rule(rule: &PlacementRule) -> Self {
        match rule {
            PlacementRule::Random { .. } => Self::Random,
            PlacementRule::Within { .. } => Self::Within,
            PlacementRule::Fixed { .. } => Self::Fixed,
            PlacementRule::OneOf { .. } => Self::OneOf,
        }
    }
}

/// What the walls around are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EnclosureKind {
    /// A rectangle about (0, 0).
    Rectangle,
    /// Any outline.
    Polygon,
}

impl EnclosureKind {
    /// That of an enclosure.
    #[must_use]
    pub fn from_enclosure(enclosure: &Enclosure) -> Self {
        match enclosure {
            Enclosure::Rectangle { .. } => Self::Rectangle,
            Enclosure::Polygon { .. } => Self::Polygon,
        }
    }
}

impl Editor {
    /// Gives the selected obstacle another kind of motion.
    pub fn set_motion(&mut self, kind: MotionKind) {
        let snap = self.snap;
        self.step(|scenario, selection| {
            let Selection::Obstacle(k) = *selection else { return };
            let Some(obstacle) = scenario.obstacles.get(k) else { return };
            if MotionKind::from_motion(&obstacle.motion) == kind {
                return;
            }
            let motion = match (kind, &obstacle.motion) {
                (MotionKind::Static, _) => ObstacleMotion::Static,
                (MotionKind::Orbit, _) => orbit(scenario, obstacle),
                (MotionKind::Patrol, ObstacleMotion::BackAndForth { waypoints_m, speed_m_s }) => {
                    ObstacleMotion::Patrol { waypoints_m: waypoints_m.clone(), speed_m_s: *speed_m_s }
                }
                (MotionKind::BackAndForth, ObstacleMotion::Patrol { waypoints_m, speed_m_s }) => {
                    ObstacleMotion::BackAndForth { waypoints_m: waypoints_m.clone(), speed_m_s: *speed_m_s }
                }
                (MotionKind::Patrol, _) => {
                    ObstacleMotion::Patrol { waypoints_m: path(scenario, k, true), speed_m_s: SPEED_M_S }
                }
                (MotionKind::BackAndForth, _) => ObstacleMotion::BackAndForth {
                    waypoints_m: path(scenario, k, false),
                    speed_m_s: SPEED_M_S,
                },
                (MotionKind::RandomWalk, _) => {
                    let room = enclosure_distance(&scenario.enclosure, obstacle.position_m);
                    let radius_m =
                        snap.disabled_if(true).size((room - bounding_radius(&obstacle.shape)).min(0.5));
                    // Each with a walk of its own.
                    let seed = u32::try_from(k).unwrap_or_default();
                    ObstacleMotion::RandomWalk { radius_m, speed_m_s: SPEED_M_S, seed }
                }
            };
            if let Some(obstacle) = scenario.obstacles.get_mut(k) {
                obstacle.motion = motion;
            }
        });
    }

    /// Gives starts or goals another kind of rule, and selects them.
    pub fn set_rule(&mut self, which: PlacementRole, kind: PlacementKind) {
        let snap = self.snap;
        self.step(|scenario, selection| {
            *selection = which.selection();
            let now = which.of(scenario);
            if PlacementKind::from_rule(now) == kind {
                return;
            }
            let clearance_m = match now {
                PlacementRule::Random { clearance_m } | PlacementRule::Within { clearance_m, .. } => {
                    *clearance_m
                }
                PlacementRule::Fixed { .. } | PlacementRule::OneOf { .. } => CLEARANCE_M,
            };
            let place = places(now).first().copied();
            let place = || place.unwrap_or_else(|| free_place(scenario, which, clearance_m, snap));
            let rule = match kind {
                PlacementKind::Random => PlacementRule::Random { clearance_m },
                PlacementKind::Within => {
                    let (low, high) = scenario.enclosure.bounds_m();
                    let quarter = |a: f32, b: f32| to_mm(a + (b - a) / 4.0);
                    let min_m = vec2(quarter(low.x, high.x), quarter(low.y, high.y));
                    let max_m = vec2(quarter(high.x, low.x), quarter(high.y, low.y));
                    PlacementRule::Within { min_m, max_m, clearance_m }
                }
                PlacementKind::Fixed => PlacementRule::Fixed { position_m: place(), heading_rad: None },
                PlacementKind::OneOf => PlacementRule::OneOf { positions_m: vec![place()] },
            };
            *which.of_mut(scenario) = rule;
        });
    }

    /// Makes the enclosure a polygon of the same four corners, or the rectangle about (0, 0) that holds all of it.
    pub fn set_enclosure(&mut self, kind: EnclosureKind) {
        self.step(|scenario, selection| {
            *selection = Selection::Enclosure;
            let enclosure = match (kind, &scenario.enclosure) {
                (EnclosureKind::Polygon, Enclosure::Rectangle { .. }) => Enclosure::Polygon {
                    corners_m: scenario.enclosure.corners_m().into_iter().map(point_to_mm).collect(),
                },
                (EnclosureKind::Rectangle, Enclosure::Polygon { .. }) => {
                    let (low, high) = scenario.enclosure.bounds_m();
                    let extent = |a: f32, b: f32| to_mm(2.0 * a.abs().max(b.abs()));
                    Enclosure::Rectangle { width_m: extent(low.x, high.x), height_m: extent(low.y, high.y) }
                }
                _ => return,
            };
            scenario.enclosure = enclosure;
        });
    }
}

/// Where the benchmark route's end is if that is in the clear, or near the middle.
fn free_place(scenario: &Scenario, which: PlacementRole, clearance_m: f32, snap: Snap) -> Vec2 {
    let end = match which {
        PlacementRole::Starts => scenario.benchmark_route.start_m,
        PlacementRole::Goals => scenario.benchmark_route.goal_m,
    };
    if clearance(scenario, end, 0) >= scenario.task.collision_range_m {
        return end;
    }
    near(scenario, middle_of(scenario), clearance_m, snap)
}

/// About the world's middle, if there is room for it; or a small circle beside it.
fn orbit(scenario: &Scenario, obstacle: &Obstacle) -> ObstacleMotion {
    let (at, radius_m) = (obstacle.position_m, bounding_radius(&obstacle.shape));
    let world = point_to_mm(middle_of(scenario));
    let arms = [0.5, 0.3, 0.2, 0.1];
    let beside = arms.into_iter().flat_map(|arm| WAYS.map(|Vec2 { x, y }| plus(at, vec2(arm * x, arm * y))));
    let fits = |centre: &Vec2| {
        let arm = distance(*centre, at);
        arm >= 0.05 && enclosure_distance(&scenario.enclosure, *centre) >= arm + radius_m
    };
    let centre_m = std::iter::once(world).chain(beside).find(fits).unwrap_or(plus(at, vec2(-0.1, 0.0)));
    // Obstacles may move at 5 m/s at most.
    let fastest = 5.0 / distance(centre_m, at).max(0.01);
    ObstacleMotion::Orbit { centre_m: point_to_mm(centre_m), speed_rad_s: SPEED_RAD_S.min(fastest) }
}

/// To the left first: there is the middle, seen from where most things are not.
const WAYS: [Vec2; 4] = [vec2(-1.0, 0.0), vec2(1.0, 0.0), vec2(0.0, -1.0), vec2(0.0, 1.0)];

/// The waypoints of a path that stays within the walls and, if it can be, clear of what stands there: a square, or one
/// straight line.
fn path(scenario: &Scenario, index: usize, square: bool) -> Vec<Vec2> {
    let mut others = scenario.clone();
    let obstacle = others.obstacles.remove(index);
    let (at, radius_m) = (obstacle.position_m, bounding_radius(&obstacle.shape));
    let candidate = |side: f32, way: usize| -> Vec<Vec2> {
        let Vec2 { x, y } = WAYS[way];
        // Counterclockwise.
        let all = [(x, y), (x - y, y + x), (-y, x)];
        all[..if square { 3 } else { 1 }]
            .iter()
            .map(|&(x, y)| point_to_mm(plus(at, Vec2 { x: side * x, y: side * y })))
            .collect()
    };
    let sides = [1.0, 0.75, 0.5, 0.3, 0.2, 0.1];
    let all: Vec<Vec<Vec2>> =
        sides.into_iter().flat_map(|side| (0..4).map(move |way| candidate(side, way))).collect();
    let along = |path: &[Vec2]| -> Vec<Vec2> {
        let corners: Vec<Vec2> = std::iter::once(at).chain(path.iter().copied()).collect();
        let legs = corners.windows(2).flat_map(|ends| {
            let (from, way) = (ends[0], minus(ends[1], ends[0]));
            (1..=8_u8).map(move |k| plus(from, vec2(way.x * f32::from(k) / 8.0, way.y * f32::from(k) / 8.0)))
        });
        legs.chain(square.then(|| middle(at, *corners.last().unwrap_or(&at)))).collect()
    };
    let clear = |path: &&Vec<Vec2>| along(path).iter().all(|&p| clearance(&others, p, 0) >= radius_m);
    let inside =
        |path: &&Vec<Vec2>| along(path).iter().all(|&p| enclosure_distance(&others.enclosure, p) >= radius_m);
    let found = all.iter().find(clear).or_else(|| all.iter().find(inside)).or(all.last());
    found.cloned().unwrap_or_default()
}
