//! CrowdNav's circle crossing, as the shipped level generator makes it: a holonomic robot driven by ORCA has the published
//! success rate and time.
//!
//! Source: C. Chen, Y. Liu, S. Kreiss and A. Alahi, *Crowd-robot interaction*, ICRA 2019, and the repository
//! vita-epfl/CrowdNav. Published for an ORCA robot in 500 cases: 43 % success, 57 % collisions, 10.9 s.

mod common;

use common::Lab;
use wayfield::run::shipped;
use wayfield::scenario::{Motion, Scenario, Vec2, vec2};
use wayfield::task::{ArenaState, CommandedMotions, RewardConfig, TaskMode, wrap_angle};
use wayfield_orca::{Avoidance, Disc, avoiding_velocity};

const PERIOD_S: f32 = 0.25;
/// 0.3 m plus CrowdNav's margin.
const RADIUS_M: f32 = 0.31;

/// The velocity that ORCA chooses for the robot, with CrowdNav's parameters.
fn orca_velocity(state: &ArenaState, pedestrians: usize) -> Vec2 {
    let agent = Disc {
        at_m: vec2(state.pose.x_m, state.pose.y_m),
        velocity_m_s: Vec2::from_angle(state.pose.heading_rad) * state.twist.v_m_s,
        radius_m: RADIUS_M,
    };
    let disc = |index| {
        let pedestrian = state.pedestrians.0.pedestrian(index).expect("all obstacles are pedestrians");
        Disc { at_m: pedestrian.position_m, velocity_m_s: pedestrian.velocity_m_s, radius_m: RADIUS_M }
    };
    let discs: Vec<Disc> = (0..pedestrians).map(disc).collect();
    let avoidance = Avoidance {
        discs: &discs,
        points_m: &[],
        time_horizon_s: 5.0,
        static_horizon_s: 5.0,
        responsibility: 0.5,
        period_s: PERIOD_S,
    };
    let preferred = (vec2(state.goal.x_m, state.goal.y_m) - agent.at_m).clamp_length_max(1.0);
    avoiding_velocity(&agent, preferred, 1.0, &avoidance)
}

/// The time in s in which the robot reaches its goal; `None` after a collision or 25 s.
fn drive(level: &Scenario) -> Option<f32> {
    let mut lab = Lab::with(level, 1, 0, RewardConfig::default(), TaskMode::SingleGoal);
    for step in 1..=100_u8 {
        let velocity = orca_velocity(&lab.state(0), level.obstacles.len());
        let heading_rad = lab.state(0).pose.heading_rad;
        // Turned to the velocity at once, then driven straight: a holonomic robot.
        lab.edit(0, |state| {
            state.pose.heading_rad =
                if velocity == Vec2::ZERO { heading_rad } else { wrap_angle(velocity.to_angle()) };
        });
        let motion = Motion { v_m_s: velocity.length(), w_rad_s: 0.0 };
        lab.simulation.world_mut().insert_resource(CommandedMotions(vec![Some(motion)]));
        lab.step(&[0]);
        let outcome = lab.outcomes()[0];
        if outcome.collided {
            return None;
        }
        if outcome.reached {
            return Some(f32::from(step) * PERIOD_S);
        }
    }
    None
}

#[test]
fn an_orca_robot_that_the_crowd_does_not_see_has_the_published_success_rate_and_time() {
    let (_, generator) =
        shipped::level_generators().find(|(name, _)| *name == "circle-crossing").expect("it is shipped");
    let times_s: Vec<f32> =
        (0..500).filter_map(|seed| drive(&generator.level(seed).expect("a level"))).collect();
    let rate = times_s.len() as f32 / 500.0;
    let mean_s = times_s.iter().sum::<f32>() / times_s.len() as f32;
    println!("success {rate}, mean time {mean_s} s");
    assert!((0.36..=0.50).contains(&rate), "success rate {rate}");
    assert!((10.0..=11.8).contains(&mean_s), "mean time {mean_s} s");
}
