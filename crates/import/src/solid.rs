//! A static solid of an imported world, seen from above.

use glam::DVec2;
use wayfield_scenario::{Obstacle, ObstacleMotion, Shape};

use crate::round::{metres, point};

/// A static solid, in the source's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solid {
    /// Its outline.
    pub outline: Outline,
    /// Position of its centre in m.
    pub centre_m: DVec2,
    /// Rotation in rad, counterclockwise.
    pub yaw_rad: f64,
}

/// The outline of a solid in its own frame, in m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outline {
    /// A circle with this radius.
    Circle(f64),
    /// A rectangle with this extent along its own x and y axes.
    Rectangle(DVec2),
}

impl Solid {
    /// Signed distance in m from a point to its outline; negative inside.
    pub fn distance(&self, point: DVec2) -> f64 {
        let own = DVec2::from_angle(-self.yaw_rad).rotate(point - self.centre_m);
        match self.outline {
            Outline::Circle(radius) => own.length() - radius,
            Outline::Rectangle(size) => {
                let beyond = own.abs() - size / 2.0;
                beyond.max(DVec2::ZERO).length() + beyond.max_element().min(0.0)
            }
        }
    }

    /// Lower left and upper right corner of its bounding box.
    pub fn bounds(&self) -> (DVec2, DVec2) {
        let half = match self.outline {
            Outline::Circle(radius) => DVec2::splat(radius),
            Outline::Rectangle(size) => {
                let (x, y) = (
                    DVec2::from_angle(self.yaw_rad) * size.x / 2.0,
                    DVec2::from_angle(self.yaw_rad).perp() * size.y / 2.0,
                );
                x.abs() + y.abs()
            }
        };
        (self.centre_m - half, self.centre_m + half)
    }

    /// The numbers of its position, size and rotation, for range checks.
    pub fn numbers(&self) -> impl Iterator<Item = f64> + use<> {
        let size = match self.outline {
            Outline::Circle(radius) => DVec2::splat(radius),
            Outline::Rectangle(size) => size,
        };
        [self.centre_m.x, self.centre_m.y, size.x, size.y, self.yaw_rad].into_iter()
    }

    /// Whether its sizes are above 0.
    pub fn is_solid(&self) -> bool {
        match self.outline {
            Outline::Circle(radius) => radius > 0.0,
            Outline::Rectangle(size) => size.min_element() > 0.0,
        }
    }

    /// The obstacle in a scenario whose (0, 0) is at `origin_m`.
    pub fn obstacle(&self, origin_m: DVec2) -> Obstacle {
        let (shape, rotation_rad) = match self.outline {
            Outline::Circle(radius) => (Shape::Circle { radius_m: metres(radius) }, 0.0),
            Outline::Rectangle(size) => (
                Shape::Rectangle { width_m: metres(size.x), height_m: metres(size.y) },
                rotation(self.yaw_rad),
            ),
        };
        Obstacle {
            shape,
            position_m: point(self.centre_m - origin_m),
            rotation_rad,
            motion: ObstacleMotion::Static,
        }
    }
}

/// The rotation of a rectangle in rad, wrapped to -pi/2 to pi/2 and rounded.
fn rotation(yaw_rad: f64) -> f32 {
    let half_turn = std::f64::consts::PI;
    let wrapped = yaw_rad - half_turn * (yaw_rad / half_turn).round();
    // Six decimals suffice: Gazebo's files often have 1.5708 for a quarter turn.
    ((wrapped * 1e6).round() / 1e6 + 0.0) as f32
}

/// The bounding box of all solids and points: lower left and upper right corner.
pub fn bounds(solids: &[Solid], points: &[DVec2]) -> (DVec2, DVec2) {
    let boxes = solids.iter().map(Solid::bounds).chain(points.iter().map(|&point| (point, point)));
    boxes.fold((DVec2::MAX, DVec2::MIN), |(low, high), (from, to)| (low.min(from), high.max(to)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec2;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn distances_and_bounds_of_a_box_account_for_its_rotation() {
        let wall = Solid {
            outline: Outline::Rectangle(dvec2(5.0, 0.2)),
            centre_m: dvec2(2.0, 0.0),
            yaw_rad: FRAC_PI_2,
        };
        let (low, high) = wall.bounds();
        assert!(low.distance(dvec2(1.9, -2.5)) < 1e-12 && high.distance(dvec2(2.1, 2.5)) < 1e-12);
        assert!((wall.distance(dvec2(1.0, 1.0)) - 0.9).abs() < 1e-12);
        assert!((wall.distance(dvec2(2.0, 2.0)) + 0.1).abs() < 1e-12);
        assert!((wall.distance(dvec2(2.1 + 0.3, 2.5 + 0.4)) - 0.5).abs() < 1e-12);
        assert!((f64::from(wall.obstacle(DVec2::ZERO).rotation_rad).abs() - FRAC_PI_2).abs() < 1e-6);
    }
}
