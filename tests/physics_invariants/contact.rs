//! LIDAR, contact and geometry agree to 1 mm, over a million random poses in random worlds.
//!
//! Three that know nothing of each other are asked how far it is: geometry, in f64 from the scenario's numbers; rapier,
//! for the gap between the robot's disc and each collider (or how deep they are in each other); and the LIDAR, for a beam
//! towards the nearest point and one in any direction.

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
use crate::random_scenarios::{Point, middle, straight, wide, worlds};

const AGREE_M: f64 = 0.001;
const POSES: usize = 1_000_000;
const WORLDS: usize = 200;

/// The largest differences, in m.
#[derive(Default)]
struct Worst {
    rapier_m: f64,
    beam_m: f64,
    hit_m: f64,
    /// Beams towards a nearest point that is a corner, which passed beside it.
    beside: usize,
}

/// The gap that rapier sees between a disc at `at` and the nearest of `solids`; negative where they overlap.
fn gap_m(colliders: &ColliderSet, solids: &[ColliderHandle], at: Vec2, radius_m: f32) -> f64 {
    let disc = Ball::new(radius_m);
    let place = BodyPose::translation(at.x, at.y);
    let to = |solid: &ColliderHandle| {
        let solid = &colliders[*solid];
        let found = query::contact(&place, &disc, solid.position(), solid.shape(), 1000.0);
        found
            .expect("both are shapes that rapier knows")
            .map_or(f64::INFINITY, |contact| f64::from(contact.dist))
    };
    solids.iter().map(to).fold(f64::INFINITY, f64::min)
}

/// The unit vector towards the nearest point of any solid, for whom stands outside of all.
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

/// A pose in the enclosure: anywhere, or about the robot's radius from something.
fn any_place(room: &Scenario, stream: &mut Stream) -> (Point, f64) {
    let (low, high) = room.enclosure.bounds_m();
    loop {
        let at = vec2(uniform(stream, low.x, high.x), uniform(stream, low.y, high.y));
        let clear = closed_form::clearance(room, 0, wide(at));
        let outside = closed_form::clearance(&walls_only(room), 0, wide(at)) < 0.0;
        if !outside {
            return (wide(at), clear);
        }
    }
}

fn walls_only(room: &Scenario) -> Scenario {
    Scenario { enclosure: room.enclosure.clone(), ..Scenario::default() }
}

/// The room of arena 0 at its clock, with all obstacles standing where they are.
fn as_it_stands(lab: &mut Lab) -> Scenario {
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
    let mut asked = 0;
    let (mut touching, mut inside) = (0, 0);
    for (number, scenario) in worlds(2, WORLDS).enumerate() {
        let mut stream = stream(2, "a million poses", number as u64);
        let mut lab = Lab::new(&scenario, 1, number as u64);
        let clock = uniform_index(&mut stream, 100_000) as u64;
        lab.edit(0, |state| state.clock = Clock(clock));
        let room = as_it_stands(&mut lab);
        let max_m = scenario.lidar.max_range_m;
        let radius = f64::from(scenario.robot.radius_m);
        let (colliders, solids) =
            lab.with_physics(0, |bodies, _, context| (context.colliders.clone(), bodies.solids.clone()));
        let mut ranges_m = Vec::new();
        for _ in 0..POSES / WORLDS {
            let (at, clear) = any_place(&room, &mut stream);
            let told = |what: &str| format!("world {number}, {what} at {at:?}, geometry says {clear} m");
            let place = Vec2::new(at.0 as f32, at.1 as f32);
            let gap = gap_m(&colliders, &solids, place, scenario.robot.radius_m);
            // (Where shapes overlap, each says its own depth, and geometry the deepest.)
            let off = (gap - (clear - radius)).abs();
            assert!(off < AGREE_M, "{}: rapier says {gap} m for the disc of {radius} m", told("the disc"));
            worst.rapier_m = worst.rapier_m.max(off);
            touching += usize::from(gap < 0.0);
            inside += usize::from(clear < 0.0);
            asked += 1;

            let towards = towards_nearest(&colliders, &solids, place);
            let aside = Vec2::from_angle(std::f32::consts::TAU * uniform_01(&mut stream));
            let pose = Pose { x_m: place.x, y_m: place.y, heading_rad: libm::atan2f(towards.y, towards.x) };
            lidar::cast(&colliders, &solids, &pose, &[Vec2::X, aside], max_m, &mut ranges_m);
            let due = clear.clamp(0.0, f64::from(max_m));
            // (From a hair outside of a surface, the way to its nearest point is no direction that f32 can tell.)
            if clear.abs() > 1e-4 {
                let range = f64::from(ranges_m[0]);
                let off = (range - due).abs();
                if off < AGREE_M {
                    worst.beam_m = worst.beam_m.max(off);
                } else {
                    // At a corner the rounding of the direction decides whether it is hit: a beam 10 um aside misses it too.
                    let heading = f64::from(pose.heading_rad);
                    let (low, high) = closed_form::range_bounds(&room, 0, at, heading, f64::from(max_m));
                    let beside = low - AGREE_M < range && range < high + AGREE_M && high - low > AGREE_M;
                    assert!(beside, "{}: the beam reads {range} m", told("towards the nearest point"));
                    worst.beside += 1;
                }
            }
            let angle = f64::from(pose.heading_rad) + f64::from(aside.to_angle());
            let hit = check_beam(&room, at, angle, f64::from(ranges_m[1]), f64::from(max_m), &told("a beam"));
            worst.hit_m = worst.hit_m.max(hit);
        }
    }
    println!(
        "{asked} poses, {touching} touching, {inside} inside; worst: rapier {} m, towards the nearest {} m ({} beside), \
         hits {} m",
        worst.rapier_m, worst.beam_m, worst.beside, worst.hit_m
    );
    assert_eq!(asked, POSES);
    assert!(worst.beside < POSES / 10_000, "{} beams passed beside a corner", worst.beside);
    assert!(touching > POSES / 50 && inside > POSES / 100, "{touching} touched, {inside} inside");
}

/// A beam ends on a surface and goes through nothing on the way. Gives how far off it ends, in m.
fn check_beam(room: &Scenario, at: Point, angle: f64, range: f64, max: f64, told: &str) -> f64 {
    let (sin, cos) = angle.sin_cos();
    let end = (at.0 + range * cos, at.1 + range * sin);
    let there = closed_form::clearance(room, 0, end);
    let begins_inside = closed_form::clearance(room, 0, at) <= 0.0;
    if begins_inside {
        assert!(range < AGREE_M, "{told}: reads {range} m from within");
        return 0.0;
    }
    if range < max {
        assert!(there.abs() < AGREE_M, "{told}: reads {range} m, and ends {there} m from a surface");
    }
    // From the robot to 1 mm before the end, nothing is deeper than 1 mm: by as far as nothing is.
    let mut gone = 0.0;
    while gone < range - AGREE_M {
        let clear = closed_form::clearance(room, 0, straight(at, end, gone / range));
        assert!(clear > -AGREE_M, "{told}: reads {range} m, but something is met {gone} m away");
        gone += clear.max(0.0) + AGREE_M;
    }
    if range < max { there.abs() } else { 0.0 }
}

#[test]
fn a_step_tells_contact_where_geometry_does_to_a_millimetre() {
    const ARENAS: usize = 64;
    let mut stream = stream(4, "contact", 0);
    let (mut touched, mut clear_of_all, mut asked) = (0, 0, 0);
    for (number, mut scenario) in worlds(3, 40).enumerate() {
        for obstacle in &mut scenario.obstacles {
            obstacle.motion = ObstacleMotion::Static;
        }
        scenario.robot.motions = vec![Motion { v_m_s: 0.0, w_rad_s: 0.0 }];
        let mut lab = Lab::with(&scenario, ARENAS, 5, RewardConfig::default(), TaskMode::SingleGoal);
        let fresh = lab.states();
        let rooms: Vec<Scenario> =
            fresh.iter().map(|state| scenario.with_generated_obstacles(state.layout_seed)).collect();
        let radius = f64::from(scenario.robot.radius_m);
        for _ in 0..40 {
            let mut states = fresh.clone();
            let mut clears = Vec::new();
            for (state, room) in states.iter_mut().zip(&rooms) {
                // Half of them within 3 cm of contact.
                let near = uniform_01(&mut stream) < 0.5;
                let (at, clear) = (0..300)
                    .map(|_| any_place(room, &mut stream))
                    .find(|(_, clear)| !near || (clear - radius).abs() < 0.03)
                    .unwrap_or_else(|| any_place(room, &mut stream));
                state.pose = Pose { x_m: at.0 as f32, y_m: at.1 as f32, heading_rad: 0.0 };
                clears.push(clear);
            }
            sim::restore(lab.simulation.world_mut(), &states);
            lab.step(&[0; ARENAS]);
            for (arena, (state, clear)) in lab.states().iter().zip(&clears).enumerate() {
                let gap = clear - radius;
                let told = format!("world {number}, {:?}, {gap} m from contact", middle(&state.pose));
                assert!(state.scan.touching || gap > 0.0, "{told}: touches");
                assert!(!state.scan.touching || gap < AGREE_M, "{told}: does not touch");
                let moved = crate::random_scenarios::apart(middle(&state.pose), middle(&states[arena].pose));
                assert!(moved < 1e-5, "{told}: is told to stand, and goes {moved} m");
                touched += usize::from(state.scan.touching);
                clear_of_all += usize::from(!state.scan.touching);
                asked += 1;
            }
        }
    }
    assert!(asked > 100_000 && touched > 10_000 && clear_of_all > 10_000, "{touched} and {clear_of_all}");
}
