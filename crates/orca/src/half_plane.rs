//! Half planes of allowed velocities, and the best velocity in all of them.

use glam::{Vec2, vec2};

use super::{Avoidance, Disc};

/// Two lines are treated as parallel if the cross product of their directions is at most this.
const PARALLEL: f32 = 1e-5;

/// A half plane of velocities, in m/s: those to the left of a directed line.
#[derive(Clone, Copy, Debug)]
pub(super) struct HalfPlane {
    /// A point of the line.
    point: Vec2,
    /// The direction of the line, a unit vector.
    direction: Vec2,
}

impl HalfPlane {
    /// The half plane beyond `point` in the direction of the unit vector `normal`.
    fn beyond(point: Vec2, normal: Vec2) -> Self {
        Self { point, direction: vec2(normal.y, -normal.x) }
    }

    /// The velocities with which `agent` does not come within its radius of `point_m` before `horizon_s`.
    pub(super) fn avoiding_point(agent: &Disc, point_m: Vec2, horizon_s: f32) -> Self {
        let to_point = point_m - agent.at_m;
        let distance_m = to_point.length();
        let normal = if distance_m > 0.0 { -to_point / distance_m } else { Vec2::X };
        Self::beyond(-normal * ((distance_m - agent.radius_m) / horizon_s), normal)
    }

    /// The velocities with which `agent` does its share of avoiding `other` (section 4 of van den Berg et al.): u is the smallest
    /// change of the relative velocity that leads out of the velocity obstacle.
    pub(super) fn avoiding_disc(agent: &Disc, other: &Disc, avoidance: &Avoidance) -> Self {
        let position = other.at_m - agent.at_m;
        let velocity = agent.velocity_m_s - other.velocity_m_s;
        let radius = agent.radius_m + other.radius_m;
        let (squared, radius_squared) = (position.length_squared(), radius * radius);
        let touching = squared <= radius_squared;
        let horizon_s = if touching { avoidance.period_s } else { avoidance.time_horizon_s };
        // The relative velocity, from the centre of the disc that truncates the cone of the velocity obstacle.
        let w = velocity - position / horizon_s;
        let dot = w.dot(position);
        let (normal, u) = if touching || (dot < 0.0 && dot * dot > radius_squared * w.length_squared()) {
            let length = w.length();
            let normal = if length > 0.0 { w / length } else { -position.normalize_or(Vec2::X) };
            (normal, normal * (radius / horizon_s - length))
        } else {
            let leg = (squared - radius_squared).sqrt();
            // The leg of the cone on the side of the relative velocity, and the normal out of the cone.
            let (x, y) = (position.x, position.y);
            let (direction, normal) = if position.perp_dot(w) > 0.0 {
                let direction = vec2(x * leg - y * radius, x * radius + y * leg) / squared;
                (direction, direction.perp())
            } else {
                let direction = vec2(x * leg + y * radius, y * leg - x * radius) / squared;
                (direction, -direction.perp())
            };
            (normal, direction * velocity.dot(direction) - velocity)
        };
        Self::beyond(agent.velocity_m_s + u * avoidance.responsibility, normal)
    }

    /// How far outside the half plane `velocity` is; negative inside.
    fn violation(&self, velocity: Vec2) -> f32 {
        self.direction.perp_dot(self.point - velocity)
    }

    /// The best velocity on the line of this half plane, in all `others`, of at most `max_speed`; `None` if there is none.
    fn best_on_line(&self, others: &[Self], max_speed: f32, objective: Objective) -> Option<Vec2> {
        let along = self.point.dot(self.direction);
        let discriminant = along * along + max_speed * max_speed - self.point.length_squared();
        if discriminant < 0.0 {
            return None;
        }
        let (mut low, mut high) = (-along - discriminant.sqrt(), -along + discriminant.sqrt());
        for other in others {
            let denominator = self.direction.perp_dot(other.direction);
            let numerator = other.direction.perp_dot(self.point - other.point);
            if denominator.abs() <= PARALLEL {
                if numerator < 0.0 {
                    return None;
                }
            } else if denominator > 0.0 {
                high = high.min(numerator / denominator);
            } else {
                low = low.max(numerator / denominator);
            }
            if low > high {
                return None;
            }
        }
        let best = match objective {
            Objective::Direction(direction) if direction.dot(self.direction) > 0.0 => high,
            Objective::Direction(_) => low,
            Objective::Closest(wanted) => (wanted - self.point).dot(self.direction).clamp(low, high),
        };
        Some(self.point + self.direction * best)
    }
}

/// What makes a velocity the best.
#[derive(Clone, Copy)]
enum Objective {
    /// As close as possible to this one.
    Closest(Vec2),
    /// As far as possible in the direction of this unit vector.
    Direction(Vec2),
}

impl Objective {
    /// The best velocity of at most `max_speed`, ignoring all half planes.
    fn unconstrained(self, max_speed: f32) -> Vec2 {
        match self {
            Self::Closest(wanted) => wanted.clamp_length_max(max_speed),
            Self::Direction(direction) => direction * max_speed,
        }
    }
}

/// The best velocity in all `planes`. If there is none: the index of the first plane that leaves none, and the best velocity in
/// the planes before it.
fn solve(planes: &[HalfPlane], max_speed: f32, objective: Objective) -> Result<Vec2, (usize, Vec2)> {
    let mut velocity = objective.unconstrained(max_speed);
    for (index, plane) in planes.iter().enumerate() {
        if plane.violation(velocity) > 0.0 {
            velocity = plane.best_on_line(&planes[..index], max_speed, objective).ok_or((index, velocity))?;
        }
    }
    Ok(velocity)
}

/// The velocity closest to `wanted` in all `planes`, of which the first `fixed` belong to points and the rest to discs. If there
/// is none: the one that violates the planes of discs least and, if possible, none of the planes of points.
pub(super) fn best_velocity(planes: &[HalfPlane], fixed: usize, wanted: Vec2, max_speed: f32) -> Vec2 {
    let (first, mut velocity) = match solve(planes, max_speed, Objective::Closest(wanted)) {
        Ok(velocity) => return velocity,
        Err(failed) => failed,
    };
    let mut worst = 0.0;
    for (index, plane) in planes.iter().enumerate().skip(first) {
        if plane.violation(velocity) <= worst {
            continue;
        }
        // Replaces each earlier plane of a disc by the velocities that violate it no more than they violate `plane`.
        let mut projected = planes[..fixed.min(index)].to_vec();
        projected.extend(planes[fixed.min(index)..index].iter().filter_map(|other| plane.worse_than(other)));
        let inwards = plane.direction.perp();
        if let Ok(better) = solve(&projected, max_speed, Objective::Direction(inwards)) {
            velocity = better;
        }
        worst = plane.violation(velocity);
    }
    velocity
}

impl HalfPlane {
    /// The velocities that violate `other` no more than they violate this plane; `None` if all do.
    fn worse_than(&self, other: &Self) -> Option<Self> {
        let determinant = self.direction.perp_dot(other.direction);
        let point = if determinant.abs() > PARALLEL {
            let part = other.direction.perp_dot(self.point - other.point) / determinant;
            self.point + self.direction * part
        } else if self.direction.dot(other.direction) > 0.0 {
            return None;
        } else {
            (self.point + other.point) * 0.5
        };
        Some(Self { point, direction: (other.direction - self.direction).normalize_or_zero() })
    }
}
