//! Things added, copied and deleted.
//!
//! In: what is asked for, and near which place. Out: the world with it, in the clear where there is room, and selected.

use std::f32::consts::{FRAC_PI_2, TAU};

use bevy::math::{Vec2, vec2};

use super::body::bounding_radius;
use super::handles;
use super::points::{distance, minus, plus, to_mm};
use super::selection::Selection;
use super::{Editor, Snap, corners, obstacle_path};
use crate::scenario::{
    Generator, Obstacle, ObstacleMotion, PlacementRule, RandomShape, Scenario, Shape, Wall, clearance,
};

/// What can be added by one press.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NewItem {
    /// A cylinder seen from above.
    Circle,
    /// A box seen from above.
    Box,
    /// A rod with round ends.
    Capsule,
    /// A polygon of three corners, to begin with.
    Triangle,
    /// A polygon of six corners, to begin with.
    Hexagon,
    /// Obstacles that are drawn anew for every episode.
    Generator,
}

/// Something that was copied.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum EditorItem {
    Obstacle(Obstacle),
    Wall(Wall),
    Generator(Generator),
}

impl NewItem {
    fn shape(self) -> Option<Shape> {
        let corners = |count: u8, radius_m: f32, first_rad: f32| {
            let at = |k: u8| first_rad + f32::from(k) / f32::from(count) * TAU;
            let corner = |k| vec2(to_mm(radius_m * at(k).cos()), to_mm(radius_m * at(k).sin()));
            Shape::Polygon { corners_m: (0..count).map(corner).collect() }
        };
        Some(match self {
            Self::Circle => Shape::Circle { radius_m: 0.15 },
            Self::Box => Shape::Rectangle { width_m: 0.4, height_m: 0.4 },
            Self::Capsule => Shape::Capsule { length_m: 0.4, radius_m: 0.1 },
            Self::Triangle => corners(3, 0.25, FRAC_PI_2),
            Self::Hexagon => corners(6, 0.2, 0.0),
            Self::Generator => return None,
        })
    }
}

impl Editor {
    /// Adds one, near `near_m` where there is room for it, and selects it.
    pub fn add(&mut self, form: NewItem, near_m: Vec2) {
        let snap = self.snap;
        let thing = match form.shape() {
            Some(shape) => EditorItem::Obstacle(Obstacle {
                position_m: near(&self.scenario, near_m, bounding_radius(&shape), snap),
                shape,
                rotation_rad: 0.0,
                motion: ObstacleMotion::Static,
            }),
            None => EditorItem::Generator(Generator {
                count: 4,
                shape: RandomShape::Circle { radius_m: (0.1, 0.2) },
                gap_m: 0.4,
                within: None,
            }),
        };
        self.put(thing);
    }

    /// Puts it in, at the end of its list, and selects it.
    pub(super) fn put(&mut self, thing: EditorItem) {
        self.step(|scenario, selection| {
            *selection = match thing {
                EditorItem::Obstacle(obstacle) => {
                    scenario.obstacles.push(obstacle);
                    Selection::Obstacle(scenario.obstacles.len() - 1)
                }
                EditorItem::Wall(wall) => {
                    scenario.walls.push(wall);
                    Selection::Wall(scenario.walls.len() - 1)
                }
                EditorItem::Generator(generator) => {
                    scenario.generators.push(generator);
                    Selection::Generator(scenario.generators.len() - 1)
                }
            };
        });
    }

    fn selected(&self) -> Option<EditorItem> {
        let scenario = &self.scenario;
        match self.selection {
            Selection::Obstacle(k) => scenario.obstacles.get(k).cloned().map(EditorItem::Obstacle),
            Selection::Wall(k) => scenario.walls.get(k).cloned().map(EditorItem::Wall),
            Selection::Generator(k) => scenario.generators.get(k).cloned().map(EditorItem::Generator),
            _ => None,
        }
    }

    /// Whether what is selected can be copied and doubled.
    #[must_use]
    pub fn can_copy(&self) -> bool {
        matches!(self.selection, Selection::Obstacle(_) | Selection::Wall(_) | Selection::Generator(_))
    }

    /// Another one like it, beside it.
    pub fn duplicate(&mut self) {
        if let Some(thing) = self.selected() {
            let beside = beside(&self.scenario, thing, self.snap);
            self.put(beside);
        }
    }

    /// Keeps what is selected for [`paste`](Self::paste).
    pub fn copy(&mut self) {
        self.clipboard = self.selected().or_else(|| self.clipboard.take());
    }

    /// [`copy`](Self::copy) and [`delete`](Self::delete).
    pub fn cut(&mut self) {
        if self.can_copy() {
            self.copy();
            self.delete();
        }
    }

    /// Whether something was copied.
    #[must_use]
    pub fn can_paste(&self) -> bool {
        self.clipboard.is_some()
    }

    /// Puts in what was copied: at `position_m`, or beside where it was; the next time beside that one.
    pub fn paste(&mut self, position_m: Option<Vec2>) {
        let Some(thing) = self.clipboard.take() else { return };
        let thing = match position_m {
            Some(at) => thing.anew().moved(self.snapped(at, false)),
            None => beside(&self.scenario, thing, self.snap),
        };
        self.clipboard = Some(thing.clone());
        self.put(thing);
    }

    /// Whether [`delete`](Self::delete) would do something.
    #[must_use]
    pub fn can_delete(&self) -> bool {
        let given = |rule: &PlacementRule| !matches!(rule, PlacementRule::Random { .. });
        match self.selection {
            Selection::Starts => given(&self.scenario.starts),
            Selection::Goals => given(&self.scenario.goals),
            _ => self.can_copy(),
        }
    }

    /// Takes away what is selected; of a rule of starts or goals, what was given: they are anywhere then.
    pub fn delete(&mut self) {
        self.step(|scenario, selection| {
            match *selection {
                Selection::Obstacle(k) if k < scenario.obstacles.len() => drop(scenario.obstacles.remove(k)),
                Selection::Wall(k) if k < scenario.walls.len() => drop(scenario.walls.remove(k)),
                Selection::Generator(k) if k < scenario.generators.len() => {
                    scenario.generators.remove(k);
                }
                Selection::Starts => scenario.starts = PlacementRule::default(),
                Selection::Goals => scenario.goals = PlacementRule::default(),
                _ => return,
            }
            *selection = Selection::Nothing;
        });
    }
}

/// The nearest place to `wanted` that is on the grid and so far clear of everything, the benchmark route's ends and the rules'
/// places among it; `wanted` itself where there is none.
pub(super) fn near(scenario: &Scenario, wanted: Vec2, reach_m: f32, snap: Snap) -> Vec2 {
    let middle = handles::middle_of(scenario);
    let ends = [scenario.benchmark_route.start_m, scenario.benchmark_route.goal_m];
    let places = [&scenario.starts, &scenario.goals].into_iter().flat_map(super::selection::places);
    let kept: Vec<Vec2> = ends.into_iter().chain(places.copied()).collect();
    let keep_m = reach_m + scenario.task.collision_range_m + 0.02;
    let fits = |at: &Vec2| {
        clearance(scenario, *at, 0) >= reach_m && kept.iter().all(|&place| distance(place, *at) >= keep_m)
    };
    let ring_m = reach_m.max(0.1);
    let rings = (0..24_u8).flat_map(|ring| (0..ring.saturating_mul(6).max(1)).map(move |k| (ring, k)));
    rings
        .map(|(ring, k)| {
            let angle = f32::from(k) / f32::from(ring.saturating_mul(6).max(1)) * TAU;
            let away = f32::from(ring) * ring_m;
            snap.point(plus(wanted, vec2(away * angle.cos(), away * angle.sin())), middle)
        })
        .find(fits)
        .unwrap_or_else(|| snap.point(wanted, middle))
}

/// The same thing beside itself, and with another walk at random.
fn beside(scenario: &Scenario, thing: EditorItem, snap: Snap) -> EditorItem {
    let to = match &thing {
        EditorItem::Obstacle(obstacle) => {
            let reach_m = bounding_radius(&obstacle.shape);
            near(scenario, plus(obstacle.position_m, vec2(2.0 * reach_m + 0.1, 0.0)), reach_m, snap)
        }
        EditorItem::Wall(_) | EditorItem::Generator(_) => {
            let aside = if snap.on { snap.step_m.max(0.2) } else { 0.2 };
            thing.place().map_or(Vec2::ZERO, |from| plus(from, vec2(aside, -aside)))
        }
    };
    thing.anew().moved(to)
}

impl EditorItem {
    /// Its middle; a wall's first corner; a region's lower left one.
    fn place(&self) -> Option<Vec2> {
        match self {
            Self::Obstacle(obstacle) => Some(obstacle.position_m),
            Self::Wall(wall) => wall.corners_m.first().copied(),
            Self::Generator(generator) => generator.within.map(|region| region.min_m),
        }
    }

    /// The same with another walk, if it walks at random.
    fn anew(mut self) -> Self {
        if let Self::Obstacle(Obstacle { motion: ObstacleMotion::RandomWalk { seed, .. }, .. }) = &mut self {
            *seed = seed.wrapping_add(1);
        }
        self
    }

    /// The same with that at `to`.
    fn moved(mut self, to: Vec2) -> Self {
        let Some(from) = self.place() else { return self };
        let by = minus(to, from);
        match &mut self {
            Self::Obstacle(obstacle) => obstacle_path::shift(obstacle, by),
            Self::Wall(wall) => corners::shift(&mut wall.corners_m, by),
            Self::Generator(generator) => {
                let region = generator.within.as_mut();
                corners::shift(region.into_iter().flat_map(|r| [&mut r.min_m, &mut r.max_m]), by);
            }
        }
        self
    }
}
