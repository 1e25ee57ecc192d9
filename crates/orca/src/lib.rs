//! Optimal reciprocal collision avoidance: of the velocities that lead to no collision within a time horizon, the one closest
//! to the preferred velocity.
//!
//! Source: J. van den Berg, S. J. Guy, M. Lin and D. Manocha, *Reciprocal n-body collision avoidance*, Robotics Research,
//! STAR 70, Springer 2011. Each disc allows a half plane of velocities (section 4). The nearest point of a wall or static
//! obstacle allows those with which the agent does not reach it within a horizon (section 5.4, for a current velocity of zero).
//! The best velocity is found by a linear program in two dimensions. If no velocity is in all half planes, the result is the
//! velocity that least violates the half planes of the discs.
//!
//! (The crate `dodgy_2d`, a port of the authors' RVO2, is not used: it draws random numbers, and brings second versions of glam
//! and rand, one of which does not build for browsers.)
//!
//! ```
//! use glam::Vec2;
//! use wayfield_orca::{Avoidance, Disc, avoiding_velocity};
//!
//! // Two agents head on, 2 m apart: each does half of the avoiding.
//! let agent = Disc { at_m: Vec2::ZERO, velocity_m_s: Vec2::X, radius_m: 0.3 };
//! let other = Disc { at_m: Vec2::new(2.0, 0.1), velocity_m_s: Vec2::NEG_X, radius_m: 0.3 };
//! let avoidance = Avoidance {
//!     discs: &[other],
//!     points_m: &[],
//!     time_horizon_s: 5.0,
//!     static_horizon_s: 1.0,
//!     responsibility: 0.5,
//!     period_s: 0.2,
//! };
//! let velocity = avoiding_velocity(&agent, Vec2::X, 1.0, &avoidance);
//! assert!(velocity.y < -0.1, "to the right, as the other is on the left: {velocity}");
//! ```

mod half_plane;

use glam::Vec2;

use half_plane::{HalfPlane, best_velocity};

/// A disc that moves at constant velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    /// Its centre, in m.
    pub at_m: Vec2,
    /// Its velocity, in m/s.
    pub velocity_m_s: Vec2,
    /// Its radius, in m.
    pub radius_m: f32,
}

/// What an agent avoids, and how.
#[derive(Clone, Copy, Debug)]
pub struct Avoidance<'a> {
    /// The other discs.
    pub discs: &'a [Disc],
    /// The nearest point of each wall and static obstacle, in m.
    pub points_m: &'a [Vec2],
    /// Time within which no collision with discs is allowed, in s.
    pub time_horizon_s: f32,
    /// Time within which no collision with points is allowed, in s.
    pub static_horizon_s: f32,
    /// The agent's share of the avoidance, 0 to 1.
    pub responsibility: f32,
    /// Time in which discs that already touch the agent are to be clear of it, in s.
    pub period_s: f32,
}

/// The velocity of `agent`, in m/s, that is closest to `preferred_m_s`, at most `max_speed_m_s` fast, and avoids the
/// discs and points of `avoidance`.
#[must_use]
pub fn avoiding_velocity(
    agent: &Disc,
    preferred_m_s: Vec2,
    max_speed_m_s: f32,
    avoidance: &Avoidance,
) -> Vec2 {
    let point = |point_m: &Vec2| HalfPlane::avoiding_point(agent, *point_m, avoidance.static_horizon_s);
    let disc = |other: &Disc| HalfPlane::avoiding_disc(agent, other, avoidance);
    let mut planes: Vec<HalfPlane> = avoidance.points_m.iter().map(point).collect();
    let fixed = planes.len();
    planes.extend(avoidance.discs.iter().map(disc));
    best_velocity(&planes, fixed, preferred_m_s, max_speed_m_s)
}

#[cfg(test)]
mod tests {
    use glam::vec2;

    use super::*;

    fn avoidance<'a>(discs: &'a [Disc], points_m: &'a [Vec2]) -> Avoidance<'a> {
        Avoidance {
            discs,
            points_m,
            time_horizon_s: 5.0,
            static_horizon_s: 1.0,
            responsibility: 0.5,
            period_s: 0.25,
        }
    }

    #[test]
    fn a_wall_ahead_allows_the_speed_that_reaches_it_after_the_horizon() {
        let agent = Disc { at_m: Vec2::ZERO, velocity_m_s: Vec2::ZERO, radius_m: 0.3 };
        // 0.5 m of free path in 1 s.
        let velocity = avoiding_velocity(&agent, vec2(1.0, 0.0), 1.0, &avoidance(&[], &[vec2(0.8, 0.0)]));
        assert!((velocity - vec2(0.5, 0.0)).length() < 1e-5, "{velocity}");
        let free = avoiding_velocity(&agent, vec2(0.0, 1.0), 1.0, &avoidance(&[], &[vec2(0.8, 0.0)]));
        assert_eq!(free, vec2(0.0, 1.0), "along the wall, nothing changes");
    }

    #[test]
    fn two_agents_that_meet_head_on_pass_each_other_symmetrically() {
        let mut agents = [
            Disc { at_m: vec2(-2.0, 0.001), velocity_m_s: vec2(1.0, 0.0), radius_m: 0.3 },
            Disc { at_m: vec2(2.0, -0.001), velocity_m_s: vec2(-1.0, 0.0), radius_m: 0.3 },
        ];
        let mut least_m = f32::INFINITY;
        for _ in 0..24 {
            let velocities = [0, 1].map(|own| {
                let preferred = if own == 0 { vec2(1.0, 0.0) } else { vec2(-1.0, 0.0) };
                avoiding_velocity(&agents[own], preferred, 1.0, &avoidance(&[agents[1 - own]], &[]))
            });
            assert!((velocities[0] + velocities[1]).length() < 1e-3, "mirrored: {velocities:?}");
            for (agent, velocity) in agents.iter_mut().zip(velocities) {
                agent.velocity_m_s = velocity;
                agent.at_m += velocity * 0.25;
            }
            least_m = least_m.min((agents[0].at_m - agents[1].at_m).length());
        }
        assert!(agents[0].at_m.x > 1.0, "they have passed: {agents:?}");
        assert!(least_m > 0.599 && least_m < 0.7, "without touching and without a detour: {least_m} m");
    }
}
