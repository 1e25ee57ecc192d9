//! Drawing tools: walls, paths of obstacles, and positions of starts or goals, point by point.
//!
//! A complete wall or path is one undo step, and so is each position.

use bevy::math::Vec2;

use super::document::Editor;
use super::items::ListItem;
use super::kinds::{PlacementKind, PlacementRole};
use super::limits::{MAX_POINTS, NEW_SPEED_M_S, NEW_WALL_THICKNESS_M, WALL_CORNERS};
use super::points::distance;
use super::selection::Selection;
use super::tool::Tool;
use crate::scenario::{PlacementRule, Scenario, Wall};

impl Editor {
    /// The current tool.
    #[must_use]
    pub fn tool(&self) -> &Tool {
        &self.tool
    }

    /// The kind of the unfinished drawing, `wall` or `path`, once it has a point. It is not part of the scenario yet.
    #[must_use]
    pub fn unfinished_drawing(&self) -> Option<&'static str> {
        match self.tool {
            _ if self.tool.points_m().is_empty() => None,
            Tool::Wall { .. } => Some("wall"),
            _ => Some("path"),
        }
    }

    /// Whether there is an unfinished wall or path with at least one point.
    #[must_use]
    pub fn is_drafting(&self) -> bool {
        self.unfinished_drawing().is_some()
    }

    /// Finishes an unfinished drawing, then selects `tool` if it fits the selected item.
    pub fn set_tool(&mut self, tool: Tool) {
        self.end_drag();
        self.close_group();
        self.finish_drawing();
        let fits = match tool {
            Tool::Select | Tool::Wall { .. } => true,
            Tool::Path { .. } => matches!(self.selection, Selection::Obstacle(_)),
            Tool::Positions => PlacementRole::from_selection(self.selection).is_some(),
        };
        if fits {
            self.tool = tool;
        }
    }

    /// Uses the tool at `position_m`; `free` disables snapping. A second click on the same point is ignored.
    pub fn click_with_tool(&mut self, position_m: Vec2, free: bool) {
        if !position_m.is_finite() {
            return;
        }
        let at = self.snapped(position_m, free);
        if self.tool == Tool::Positions {
            return self.add_position(at);
        }
        if let Some(points) = self.tool.points_mut()
            && points.len() < MAX_POINTS
            && points.last().is_none_or(|&last| distance(last, at) > 0.0)
        {
            points.push(at);
        }
    }

    /// Adds a position to the selected rule.
    fn add_position(&mut self, position_m: Vec2) {
        self.step(|scenario, selection| {
            let Some(role) = PlacementRole::from_selection(*selection) else { return };
            let mut positions_m = role.of(scenario).positions_m().to_vec();
            if positions_m.len() < MAX_POINTS && !positions_m.contains(&position_m) {
                positions_m.push(position_m);
                *role.of_mut(scenario) = PlacementRule::OneOf { positions_m };
            }
        });
    }

    /// Finishes the drawing and deselects the tool. A wall or path with too few points is discarded.
    pub fn finish_tool(&mut self) {
        match std::mem::take(&mut self.tool) {
            Tool::Wall { corners_m } if corners_m.len() >= *WALL_CORNERS.start() => {
                self.append(ListItem::Wall(Wall {
                    corners_m,
                    thickness_m: NEW_WALL_THICKNESS_M,
                    ..Wall::default()
                }));
            }
            Tool::Path { waypoints_m } if !waypoints_m.is_empty() => self.set_path(waypoints_m),
            _ => {}
        }
    }

    /// Finishes an unfinished wall or path. Without one, the tool stays selected.
    pub fn finish_drawing(&mut self) {
        if self.is_drafting() {
            self.finish_tool();
        }
    }

    /// Sets the path of the selected obstacle; if it has no path yet, its motion becomes a patrol.
    fn set_path(&mut self, path: Vec<Vec2>) {
        self.step(|scenario, selection| {
            let Selection::Obstacle(k) = *selection else { return };
            let Some(obstacle) = scenario.obstacles.get_mut(k) else { return };
            obstacle.set_path(path, NEW_SPEED_M_S);
        });
    }

    /// Removes the last point of the drawing; without a point, deselects the tool.
    pub fn undo_tool_point(&mut self) {
        if self.tool.points_mut().and_then(Vec::pop).is_none() {
            self.cancel_tool();
        }
    }

    /// Deselects the tool if it no longer fits after a change. The path and positions tools need the selection to be
    /// `selected` as before; the positions tool also needs a rule that lists positions or is of the same kind as in
    /// `before`.
    pub(super) fn check_tool(&mut self, before: &Scenario, selected: Selection) {
        let role = PlacementRole::from_selection(selected);
        let kind = |scenario: &Scenario| role.map(|role| PlacementKind::from_rule(role.of(scenario)));
        let same = self.selection == selected;
        let fits = match self.tool {
            Tool::Select | Tool::Wall { .. } => true,
            Tool::Path { .. } => same,
            Tool::Positions => {
                let now = kind(&self.scenario);
                same && (now == Some(PlacementKind::OneOf) || now == kind(before))
            }
        };
        if !fits {
            self.cancel_tool();
        }
    }

    /// Deselects the tool and discards an unfinished drawing.
    pub fn cancel_tool(&mut self) {
        self.tool = Tool::Select;
    }
}
