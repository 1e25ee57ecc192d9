//! LIDAR, contact and geometry agree to 1 mm, over a million random poses in random scenarios.
//!
//! Three independent methods measure distances: geometry, in f64 from the scenario's numbers; rapier, as the gap or
//! penetration between the robot's disc and each collider; and the LIDAR, with a beam towards the nearest point and a beam in
//! a random direction.

use bevy::math::{Vec2, vec2};
use bevy_rapier2d::rapier::math::Pose as BodyPose;
use bevy_rapier2d::rapier::parry::query;
use bevy_rapier2d::rapier::parry::shape::Ball;
use bevy_rapier2d::rapier::prelude::{ColliderHandle, ColliderSet};
use wayfield::random::{Stream, stream, uniform, uniform_01, uniform_index};
use wayfield::scenario::{Motion, ObstacleMotion, Scenario};
use wayfield::sim::{self, lidar};
use wayfield::task::{Clock, Pose, RewardConfig, TaskMode};

use crate::common::{Lab, closed_form};
use crate::random_scenarios::{Point, centre, distance, interpolate, scenarios, to_f64};

/// The largest allowed difference, in m.
const TOLERANCE_M: f64 = 0.001;
const POSES: usize = 1_000_000;
const SCENARIOS: usize = 200;

/// The largest differences.
#[derive(Default)]
struct Worst {
    rapier_m: f64,
    beam_m: f64,
    hit_m: f64,
    /// The number of beams towards a corner that missed the corner.
    missed_corners: usize,
}

/// Rapier's gap between a disc at `at` and the nearest of `solids`, in m; negative if they overlap.
fn gap_m(colliders: &ColliderSet, solids: &[ColliderHandle], at: Vec2, radius_m: f32) -> f64 {
    let disc = Ball::new(radius_m);
    let place = BodyPose::translation(at.x, at.y);
    let to = |solid: &ColliderHandle| {
        let solid = &colliders[*solid];
        let found = query::contact(&place, &disc, solid.position(), solid.shape(), 1000.0);
        found.expect("rapier supports both shapes").map_or(f64::INFINITY, |contact| f64::from(contact.dist))
    };
    solids.iter().map(to).fold(f64::INFINITY, f64::min)
}

/// The unit vector from a point outside all solids towards the nearest point of any solid.
fn towards_nearest(colliders: &ColliderSet, solids: &[ColliderHandle], at: Vec2) -> Vec2 {
    let nearest = solids.iter().map(|solid| {
        let solid = &colliders[*solid];
        solid.shape().project_point(solid.position(), at, true).point - at
    });
    nearest
        .min_by(|a, b| a.length_squared().total_cmp(&b.length_squared()))
        .unwrap_or(Vec2::X)
        .normalize_or(Vec2::X)
}

/// A random point in the enclosure, and its clearance in m.
fn any_point(layout: &Scenario, stream: &mut Stream) -> (Point, f64) {
    let (low, high) = layout.enclosure.bounds_m();
    loop {
        let at = vec2(uniform(stream, low.x, high.x), uniform(stream, low.y, high.y));
        let clear = closed_form::clearance(layout, 0, to_f64(at));
        let outside = closed_form::clearance(&enclosure_only(layout), 0, to_f64(at)) < 0.0;
        if !outside {
            return (to_f64(at), clear);
        }
    }
}

fn enclosure_only(layout: &Scenario) -> Scenario {
    Scenario { enclosure: layout.enclosure.clone(), ..Scenario::default() }
}

/// The layout of arena 0 with all obstacles static at their current poses.
fn current_layout(lab: &mut Lab) -> Scenario {
    let state = lab.state(0);
    crate::random_scenarios::between_steps(
        &lab.scenario.with_generated_obstacles(state.layout_seed),
        state.clock.0,
        0.0,
    )
}

#[test]
fn lidar_contact_and_geometry_agree_to_a_millimetre_over_a_million_poses() {
    let mut worst = Worst::default();
    let mut poses = 0;
    let (mut touching, mut inside) = (0, 0);
    for (number, scenario) in scenarios(2, SCENARIOS).enumerate() {
        let mut stream = stream(2, "a million poses", number as u64);
        let mut lab = Lab::new(&scenario, 1, number as u64);
        let clock = uniform_index(&mut stream, 100_000) as u64;
        lab.edit(0, |state| state.clock = Clock(clock));
        let layout = current_layout(&mut lab);
        let max_m = scenario.lidar.max_range_m;
        let radius = f64::from(scenario.robot.radius_m);
        let (colliders, solids) =
            lab.with_physics(0, |bodies, _, context| (context.colliders.clone(), bodies.solids.clone()));
        let mut ranges_m = Vec::new();
        for _ in 0..POSES / SCENARIOS {
            let (at, clear) = any_point(&layout, &mut stream);
            let context = |what: &str| format!("scenario {number}, {what} at {at:?}, clearance {clear} m");
            let position = Vec2::new(at.0 as f32, at.1 as f32);
            let gap = gap_m(&colliders, &solids, position, scenario.robot.radius_m);
            // If shapes overlap, rapier's smallest gap and the clearance are both those of the deepest penetration.
            let off = (gap - (clear - radius)).abs();
            assert!(
                off < TOLERANCE_M,
                "{}: rapier's gap is {gap} m for a radius of {radius} m",
                context("disc")
            );
            worst.rapier_m = worst.rapier_m.max(off);
            touching += usize::from(gap < 0.0);
            inside += usize::from(clear < 0.0);
            poses += 1;

            let towards = towards_nearest(&colliders, &solids, position);
            let random_direction = Vec2::from_angle(std::f32::consts::TAU * uniform_01(&mut stream));
            let heading_rad = libm::atan2f(towards.y, towards.x);
            let pose = Pose { x_m: position.x, y_m: position.y, heading_rad };
            lidar::cast(&colliders, &solids, &pose, &[Vec2::X, random_direction], max_m, &mut ranges_m);
            let expected = clear.clamp(0.0, f64::from(max_m));
            // Very close to a surface, f32 cannot represent the direction to the nearest point.
            if clear.abs() > 1e-4 {
                let range = f64::from(ranges_m[0]);
                let off = (range - expected).abs();
                if off < TOLERANCE_M {
                    worst.beam_m = worst.beam_m.max(off);
                } else {
                    // The rounding of the direction decides whether a corner is hit: beams shifted by up to 10 um may hit or
                    // miss it.
                    let heading = f64::from(pose.heading_rad);
                    let (low, high) = closed_form::range_bounds(&layout, 0, at, heading, f64::from(max_m));
                    let in_bounds = low - TOLERANCE_M < range && range < high + TOLERANCE_M;
                    let missed_corner = in_bounds && high - low > TOLERANCE_M;
                    assert!(missed_corner, "{}: range {range} m", context("beam to the nearest point"));
                    worst.missed_corners += 1;
                }
            }
            let angle = f64::from(pose.heading_rad) + f64::from(random_direction.to_angle());
            let range = f64::from(ranges_m[1]);
            let hit = check_beam(&layout, at, angle, range, f64::from(max_m), &context("random beam"));
            worst.hit_m = worst.hit_m.max(hit);
        }
    }
    println!(
        "{poses} poses, {touching} touching, {inside} inside; largest errors: rapier {} m, beam to the nearest point {} m \
         ({} missed corners), random beam {} m",
        worst.rapier_m, worst.beam_m, worst.missed_corners, worst.hit_m
    );
    assert_eq!(poses, POSES);
    assert!(worst.missed_corners < POSES / 10_000, "{} beams missed a corner", worst.missed_corners);
    assert!(touching > POSES / 50 && inside > POSES / 100, "{touching} touching, {inside} inside");
}

/// Asserts that a beam ends on a surface and passes through nothing. Returns the distance of its end from the surface, in m.
fn check_beam(layout: &Scenario, at: Point, angle: f64, range: f64, max: f64, context: &str) -> f64 {
    let (sin, cos) = angle.sin_cos();
    let end = (at.0 + range * cos, at.1 + range * sin);
    let end_clearance = closed_form::clearance(layout, 0, end);
    let starts_inside = closed_form::clearance(layout, 0, at) <= 0.0;
    if starts_inside {
        assert!(range < TOLERANCE_M, "{context}: range {range} m from inside a solid");
        return 0.0;
    }
    if range < max {
        let off = end_clearance.abs();
        assert!(off < TOLERANCE_M, "{context}: range {range} m ends {end_clearance} m from a surface");
    }
    // Advances along the beam by the clearance, up to 1 mm before its end. No point may be deeper than 1 mm inside a solid.
    let mut travelled = 0.0;
    while travelled < range - TOLERANCE_M {
        let clear = closed_form::clearance(layout, 0, interpolate(at, end, travelled / range));
        assert!(clear > -TOLERANCE_M, "{context}: range {range} m, but there is a solid at {travelled} m");
        travelled += clear.max(0.0) + TOLERANCE_M;
    }
    if range < max { end_clearance.abs() } else { 0.0 }
}

#[test]
fn a_step_reports_contact_in_agreement_with_geometry_to_a_millimetre() {
    const ARENAS: usize = 64;
    let mut stream = stream(4, "contact", 0);
    let (mut touching, mut free, mut cases) = (0, 0, 0);
    for (number, mut scenario) in scenarios(3, 40).enumerate() {
        for obstacle in &mut scenario.obstacles {
            obstacle.motion = ObstacleMotion::Static;
        }
        scenario.robot.motions = vec![Motion { v_m_s: 0.0, w_rad_s: 0.0 }];
        let mut lab = Lab::with(&scenario, ARENAS, 5, RewardConfig::default(), TaskMode::SingleGoal);
        let fresh = lab.states();
        let layouts: Vec<Scenario> =
            fresh.iter().map(|state| scenario.with_generated_obstacles(state.layout_seed)).collect();
        let radius = f64::from(scenario.robot.radius_m);
        for _ in 0..40 {
            let mut states = fresh.clone();
            let mut clears = Vec::new();
            for (state, layout) in states.iter_mut().zip(&layouts) {
                // Half of the robots are within 3 cm of contact.
                let near = uniform_01(&mut stream) < 0.5;
                let (at, clear) = (0..300)
                    .map(|_| any_point(layout, &mut stream))
                    .find(|(_, clear)| !near || (clear - radius).abs() < 0.03)
                    .unwrap_or_else(|| any_point(layout, &mut stream));
                state.pose = Pose { x_m: at.0 as f32, y_m: at.1 as f32, heading_rad: 0.0 };
                clears.push(clear);
            }
            sim::restore(lab.simulation.world_mut(), &states);
            lab.step(&[0; ARENAS]);
            for (arena, (state, clear)) in lab.states().iter().zip(&clears).enumerate() {
                let gap = clear - radius;
                let context = format!("scenario {number}, {:?}, gap {gap} m", centre(&state.pose));
                assert!(state.scan.touching || gap > 0.0, "{context}: the contact is not reported");
                assert!(!state.scan.touching || gap < TOLERANCE_M, "{context}: a contact is reported");
                let moved = distance(centre(&state.pose), centre(&states[arena].pose));
                assert!(moved < 1e-5, "{context}: moves {moved} m although commanded to stand still");
                touching += usize::from(state.scan.touching);
                free += usize::from(!state.scan.touching);
                cases += 1;
            }
        }
    }
    assert!(cases > 100_000 && touching > 10_000 && free > 10_000, "{touching} touching, {free} free");
}
