//! Tools: what is drawn corner by corner, click by click.
//!
//! In: clicks. Out: a wall, the path of an obstacle, or places for starts or goals; a wall or a path is one step for
//! undo, a place is one each.

use super::items::EditorItem;
use super::points::{distance, is_finite};
use super::selection::{Selection, places};
use super::{Editor, PlacementKind};
use crate::scenario::{ObstacleMotion, PlacementRule, Scenario, Wall};
use bevy::math::Vec2;

/// How thick a new wall is, in m.
const WALL_THICKNESS_M: f32 = 0.1;
/// The speed of a new path, in m/s.
pub(super) const SPEED_M_S: f32 = 0.1;
/// The most corners of a wall, of a path, and places of a rule.
const MAX_POINTS: usize = 256;

/// What a click in the world does.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Tool {
    /// Selects.
    #[default]
    Select,
    /// Sets the next corner of a new wall.
    Wall {
        /// Those so far.
        corners_m: Vec<Vec2>,
    },
    /// Sets the next waypoint of the selected obstacle's path.
    Path {
        /// Those so far.
        waypoints_m: Vec<Vec2>,
    },
    /// Sets one more place of the selected rule.
    Places,
}

impl Editor {
    /// What a click does now.
    #[must_use]
    pub fn tool(&self) -> &Tool {
        &self.tool
    }

    /// Whether a wall or a path is half drawn: it is not in the world yet.
    #[must_use]
    pub fn is_drafting(&self) -> bool {
        match &self.tool {
            Tool::Wall { corners_m: corners } | Tool::Path { waypoints_m: corners } => !corners.is_empty(),
            Tool::Select | Tool::Places => false,
        }
    }

    /// Takes a tool, if what is selected is something for it.
    pub fn set_tool(&mut self, tool: Tool) {
        self.end_drag();
        self.close_group();
        let fits = match tool {
            Tool::Select | Tool::Wall { .. } => true,
            Tool::Path { .. } => matches!(self.selection, Selection::Obstacle(_)),
            Tool::Places => matches!(self.selection, Selection::Starts | Selection::Goals),
        };
        if fits {
            self.tool = tool;
        }
    }

    /// A click in the world with the tool; `free` is without snapping.
    pub fn click_with_tool(&mut self, position_m: Vec2, free: bool) {
        if !is_finite(position_m) {
            return;
        }
        let at = self.snapped(position_m, free);
        match &mut self.tool {
            Tool::Select => {}
            Tool::Wall { corners_m: corners } | Tool::Path { waypoints_m: corners } => {
                // A click twice in the same place is one corner.
                if corners.len() < MAX_POINTS && corners.last().is_none_or(|&last| distance(last, at) > 0.0) {
                    corners.push(at);
                }
            }
            Tool::Places => self.step(|scenario, selection| {
                let rule = match selection {
                    Selection::Starts => &mut scenario.starts,
                    Selection::Goals => &mut scenario.goals,
                    _ => return,
                };
                let mut all = places(rule).to_vec();
                if all.len() < MAX_POINTS && !all.contains(&at) {
                    all.push(at);
                    *rule = PlacementRule::OneOf { positions_m: all };
                }
            }),
        }
    }

    /// It is all drawn: the wall or the path is there, if it has corners enough.
    pub fn finish_tool(&mut self) {
        match std::mem::take(&mut self.tool) {
            Tool::Wall { corners_m } if corners_m.len() >= 2 => {
                self.put(EditorItem::Wall(Wall { corners_m, thickness_m: WALL_THICKNESS_M }));
            }
            Tool::Path { waypoints_m } if !waypoints_m.is_empty() => self.set_path(waypoints_m),
            _ => {}
        }
    }

    /// Gives the selected obstacle this path, of the kind that it has or else a patrol.
    fn set_path(&mut self, path: Vec<Vec2>) {
        self.step(|scenario, selection| {
            let Selection::Obstacle(k) = *selection else { return };
            let Some(obstacle) = scenario.obstacles.get_mut(k) else { return };
            match &mut obstacle.motion {
                ObstacleMotion::Patrol { waypoints_m, .. }
                | ObstacleMotion::BackAndForth { waypoints_m, .. } => *waypoints_m = path,
                motion => *motion = ObstacleMotion::Patrol { waypoints_m: path, speed_m_s: SPEED_M_S },
            }
        });
    }

    /// The last corner was not meant; without any, the tool is put away.
    pub fn undo_tool_point(&mut self) {
        let left = match &mut self.tool {
            Tool::Wall { corners_m: corners } | Tool::Path { waypoints_m: corners } => {
                corners.pop().is_some()
            }
            Tool::Select | Tool::Places => false,
        };
        if !left {
            self.cancel_tool();
        }
    }

    /// Puts the tool away after a change if it was for what was `selected`, and that is selected no more; or if the rule
    /// is of another kind than in the world `before`, and has no places to be added to.
    pub(super) fn check_tool(&mut self, before: &Scenario, selected: Selection) {
        let kind = |scenario: &Scenario| match selected {
            Selection::Starts => Some(PlacementKind::from_rule(&scenario.starts)),
            Selection::Goals => Some(PlacementKind::from_rule(&scenario.goals)),
            _ => None,
        };
        let same = self.selection == selected;
        let fits = match self.tool {
            Tool::Select | Tool::Wall { .. } => true,
            Tool::Path { .. } => same,
            Tool::Places => {
                let now = kind(&self.scenario);
                same && (now == Some(PlacementKind::OneOf) || now == kind(before))
            }
        };
        if !fits {
            self.cancel_tool();
        }
    }

    /// Puts the tool away; what was not ended is gone.
    pub fn cancel_tool(&mut self) {
        self.tool = Tool::Select;
    }
}
