//! LIDAR ranges agree with geometry, and the beams hit the same colliders as the robot.

mod common;

use std::f32::consts::PI;

use bevy::math::{Vec2, vec2};
use bevy_rapier2d::prelude::{RapierContextColliders, RapierContextSimulation, RapierRigidBodySet};
use bevy_rapier2d::rapier::parry::query::DefaultQueryDispatcher;
use bevy_rapier2d::rapier::prelude::{
    ColliderBuilder, ColliderHandle, ColliderSet, QueryFilter, Ray, Vector,
};
use common::{Lab, bits, closed_form};
use proptest::prelude::*;
use wayfield::scenario::{Enclosure, Lidar, Scenario, Shape, Wall};
use wayfield::sim::{Bodies, lidar};
use wayfield::task::{Pose, RewardConfig, TaskMode};

fn pose(x_m: f32, y_m: f32, heading_rad: f32) -> Pose {
    Pose { x_m, y_m, heading_rad }
}

/// Asserts that every range from `from` agrees with the closed form to 1e-5 m. The range of a grazing beam must lie between
/// those of beams shifted by 10 um to either side.
fn assert_closed_form(lab: &mut Lab, from: &Pose) {
    let (scenario, clock) = (lab.scenario.clone(), lab.state(0).clock.0);
    let ranges = lab.cast(0, from);
    let beams = scenario.lidar.beams;
    assert_eq!(ranges.len(), beams, "one range per beam");
    let origin = (f64::from(from.x_m), f64::from(from.y_m));
    for (i, &range) in ranges.iter().enumerate() {
        // With a full field of view, beam 0 points ahead and the others follow counterclockwise. Otherwise the beams go from
        // right to left.
        let view = f64::from(scenario.lidar.field_of_view_rad);
        let full = i as f64 * std::f64::consts::TAU / beams as f64;
        let partial = if beams == 1 { 0.0 } else { view * (i as f64 / (beams - 1) as f64 - 0.5) };
        let angle = f64::from(from.heading_rad) + if view > 6.27 { full } else { partial };
        let max_m = f64::from(scenario.lidar.max_range_m);
        let (low, high) = closed_form::range_bounds(&scenario, clock, origin, angle, max_m);
        let range = f64::from(range);
        assert!(
            range > low - 1e-5 && range < high + 1e-5,
            "beam {i} of {beams} from {from:?}: range {range} m, expected {low} to {high} m"
        );
    }
}

fn one_obstacle(shape: Shape, at: Vec2, turn: f32) -> Scenario {
    Scenario { obstacles: vec![common::static_obstacle(shape, at, turn)], ..Scenario::default() }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn ranges_to_circles_and_walls_match_the_closed_form(
        r in 0.1_f32..0.8, x in -1.5_f32..1.5, y in -1.5_f32..1.5,
        px in -1.99_f32..1.99, py in -1.99_f32..1.99, heading in -PI..PI,
        beams in prop_oneof![Just(24_usize), 1_usize..100],
    ) {
        let mut scenario = one_obstacle(Shape::Circle { radius_m: r }, vec2(x, y), 0.0);
        scenario.lidar.beams = beams;
        assert_closed_form(&mut Lab::new(&scenario, 1, 1), &pose(px, py, heading));
    }

    #[test]
    fn ranges_to_rotated_boxes_match_the_closed_form(
        w in 0.01_f32..1.5, h in 0.01_f32..1.5, x in -1.5_f32..1.5, y in -1.5_f32..1.5, turn in -6.2_f32..6.2,
        px in -1.99_f32..1.99, py in -1.99_f32..1.99, heading in -PI..PI,
    ) {
        let scenario = one_obstacle(Shape::Rectangle { width_m: w, height_m: h }, vec2(x, y), turn);
        assert_closed_form(&mut Lab::new(&scenario, 1, 1), &pose(px, py, heading));
    }

    #[test]
    fn ranges_to_capsules_polygons_and_inner_walls_match_the_closed_form(
        length in 0.01_f32..1.5, r in 0.05_f32..0.5, x in -1.5_f32..1.5, y in -1.5_f32..1.5, turn in -6.2_f32..6.2,
        px in -1.99_f32..1.99, py in -1.99_f32..1.99, heading in -PI..PI, view in 0.3_f32..6.2, sides in 3_usize..9,
    ) {
        let from = pose(px, py, heading);
        let mut capsule = one_obstacle(Shape::Capsule { length_m: length, radius_m: r }, vec2(x, y), turn);
        capsule.lidar.field_of_view_rad = view;
        assert_closed_form(&mut Lab::new(&capsule, 1, 1), &from);
        // Corners on an ellipse around a point next to the origin: convex and clockwise.
        let corner = |k: usize| {
            let (sin, cos) = (std::f32::consts::TAU * k as f32 / sides as f32).sin_cos();
            vec2(length * cos - 0.2, -r * sin + 0.1)
        };
        let corners_m = (0..sides).map(corner).collect();
        let polygon = one_obstacle(Shape::Polygon { corners_m }, vec2(x, y), turn);
        assert_closed_form(&mut Lab::new(&polygon, 1, 1), &from);
        let corners_m = vec![vec2(x, y), vec2(0.0, 1.9), vec2(-1.5, turn / 5.0)];
        let walls = vec![Wall { corners_m, thickness_m: r / 2.0, ..Wall::default() }];
        assert_closed_form(&mut Lab::new(&Scenario { walls, ..Scenario::default() }, 1, 1), &from);
    }

    #[test]
    fn ranges_in_an_l_shaped_enclosure_match_the_closed_form(
        notch in (-1.0_f32..1.0, -1.0_f32..1.0).prop_map(Vec2::from), px in -1.99_f32..1.99, py in -1.99_f32..1.99, heading in -PI..PI,
        backwards in any::<bool>(),
    ) {
        prop_assume!(px < notch.x - 0.01 || py < notch.y - 0.01);
        let mut corners_m =
            vec![vec2(-2.0, -2.0), vec2(2.0, -2.0), vec2(2.0, notch.y), notch, vec2(notch.x, 2.0), vec2(-2.0, 2.0)];
        if backwards {
            corners_m.reverse();
        }
        let scenario = Scenario { enclosure: Enclosure::Polygon { corners_m }, ..Scenario::default() };
        assert_closed_form(&mut Lab::new(&scenario, 1, 1), &pose(px, py, heading));
    }

    #[test]
    fn beams_aimed_at_a_corner_match_the_closed_form(turn in -PI..PI, from in -PI..PI, corner in 0_usize..4) {
        // A box of 0.6 m x 0.4 m at the origin. Beam 0 points at one of its corners from a distance of 1.5 m.
        let scenario = one_obstacle(Shape::Rectangle { width_m: 0.6, height_m: 0.4 }, vec2(0.0, 0.0), turn);
        let (x, y) = [(0.3, 0.2), (-0.3, 0.2), (-0.3, -0.2), (0.3, -0.2)][corner];
        let at = Vec2::from_angle(turn).rotate(Vec2::new(x, y));
        let eye = 1.5 * Vec2::from_angle(from);
        let heading = (at - eye).to_angle();
        let mut lab = Lab::new(&scenario, 1, 1);
        assert_closed_form(&mut lab, &pose(eye.x, eye.y, heading));
        let [right, left] = [-0.001, 0.001].map(|offset| lab.cast(0, &pose(eye.x, eye.y, heading + offset))[0]);
        prop_assert!(right.min(left) < (at - eye).length() + 0.02, "the box is on one side of the corner");
    }

    #[test]
    fn ranges_match_rapiers_query_pipeline(
        px in -1.99_f32..1.99, py in -1.99_f32..1.99, heading in -PI..PI, steps in 0_usize..40,
    ) {
        let mut lab = Lab::new(&common::moving_obstacles(), 1, 3);
        for _ in 0..=steps {
            lab.step(&[2]);
        }
        let ours = lab.cast(0, &pose(px, py, heading));
        let beams = Lidar::default().beam_directions();
        let world = lab.simulation.world_mut();
        let mut arenas =
            world.query::<(&Bodies, &RapierContextSimulation, &RapierRigidBodySet, &RapierContextColliders)>();
        let (bodies, context, set, colliders) = arenas.single(world).expect("one arena");
        let filter = QueryFilter::new().exclude_rigid_body(bodies.robot);
        let pipeline = context.broad_phase.as_query_pipeline(
            &DefaultQueryDispatcher, &set.bodies, &colliders.colliders, filter,
        );
        for (i, beam) in beams.iter().enumerate() {
            let theirs = |offset: f32| {
                let ray = Ray::new(Vec2::new(px, py), Vec2::from_angle(heading + offset).rotate(*beam));
                pipeline.cast_ray(&ray, 3.5, true).map_or(3.5, |(_, distance)| distance)
            };
            // The rotation of the beam is rounded differently. So a beam that grazes an edge may hit either the edge or what
            // is behind it. At an edge, rapier's ranges differ between rotations by 1e-3 and -1e-3 rad, an angle that is larger
            // than the square root of f32's rounding error.
            let (straight, left, right) = (theirs(0.0), theirs(1e-3), theirs(-1e-3));
            let at_an_edge = (left - right).abs() > 0.02
                && ours[i] > left.min(right) - 0.02
                && ours[i] < left.max(right) + 0.02;
            prop_assert!(
                (ours[i] - straight).abs() < 1e-4 || at_an_edge,
                "beam {i}: range {} m, rapier's range {straight} m",
                ours[i]
            );
        }
    }
}

#[test]
fn ranges_match_a_calculation_by_hand() {
    let scenario = one_obstacle(Shape::Circle { radius_m: 0.15 }, vec2(0.6, 0.0), 0.0);
    let mut lab = Lab::new(&scenario, 1, 1);
    let near = |a: f32, b: f32| (a - b).abs() < 1e-5;
    let ranges = lab.cast(0, &pose(0.0, 0.0, 0.0));
    assert!(near(ranges[0], 0.45), "beam 0 points ahead, at the cylinder");
    assert!(near(ranges[6], 2.0), "beam 6 points left, at the wall");
    assert!(near(ranges[12], 2.0), "beam 12 points back, at the wall");
    assert!(near(ranges[3], 2.0 * 2.0_f32.sqrt()), "beam 3 points at the corner");
    let ranges = lab.cast(0, &pose(0.0, 0.0, -PI / 2.0));
    assert!(
        near(ranges[6], 0.45),
        "beams go counterclockwise: after a turn to the right, the cylinder is on the left"
    );
    assert!(near(ranges[18], 2.0), "the cylinder is not on the right");
}

#[test]
fn beams_that_hit_nothing_report_the_maximum_range() {
    let mut lab = Lab::new(&common::wide_open(), 1, 1);
    assert_eq!(lab.cast(0, &pose(0.0, 0.0, 0.3)), vec![3.5; 24]);
    let mut short = common::four_cylinders();
    short.lidar.max_range_m = 0.3;
    assert_eq!(Lab::new(&short, 1, 1).cast(0, &pose(0.0, 0.0, 0.3)), vec![0.3; 24]);
}

#[test]
fn beams_from_inside_an_obstacle_or_a_wall_report_0() {
    for shape in [Shape::Circle { radius_m: 0.3 }, Shape::Rectangle { width_m: 0.6, height_m: 0.6 }] {
        let mut lab = Lab::new(&one_obstacle(shape, vec2(0.5, 0.5), 0.3), 1, 1);
        assert_eq!(lab.cast(0, &pose(0.55, 0.45, 1.0)), vec![0.0; 24], "inside an obstacle");
        assert_eq!(lab.cast(0, &pose(2.2, 0.0, 1.0)), vec![0.0; 24], "inside a wall");
    }
}

/// Drives straight ahead until the robot touches something. Returns the smallest gap between the robot and anything, in m.
fn drive_until_contact(scenario: &Scenario, from: Pose, max_steps: usize) -> f64 {
    let mut scenario = scenario.clone();
    let collision_range_m = scenario.task.collision_range_m;
    // Only contact ends the episode.
    scenario.task.collision_range_m = 0.0;
    let mut lab = Lab::with(&scenario, 1, 1, RewardConfig::default(), TaskMode::SingleGoal);
    lab.edit(0, |state| {
        state.pose = from;
        (state.goal.x_m, state.goal.y_m) = (-9.0, -9.0);
    });
    let (mut was_in_range, mut gap) = (false, f64::INFINITY);
    for _ in 0..max_steps {
        lab.step(&[2]);
        let state = lab.state(0);
        let at = (f64::from(state.pose.x_m), f64::from(state.pose.y_m));
        let clear = closed_form::clearance(&scenario, state.clock.0, at);
        gap = gap.min(clear - f64::from(scenario.robot.radius_m));
        was_in_range |= state.scan.nearest_m < collision_range_m;
        if state.scan.touching {
            assert!(lab.outcomes()[0].collided, "contact is a collision");
            // The collision range minus the radius is one step of 0.03 m, so at worst both happen in the same step.
            assert!(
                was_in_range,
                "the smallest range falls below the collision range no later than the contact"
            );
            return gap;
        }
    }
    panic!("no contact from {from:?}, smallest gap {gap} m");
}

#[test]
fn the_smallest_range_is_below_the_collision_range_at_contact_and_the_robot_penetrates_nothing() {
    let cylinder = one_obstacle(Shape::Circle { radius_m: 0.15 }, vec2(0.6, 0.0), 0.0);
    let slab = one_obstacle(Shape::Rectangle { width_m: 0.1, height_m: 1.0 }, vec2(0.6, 0.0), 0.0);
    let mut worst = f64::INFINITY;
    for k in 0..60 {
        // All offsets within the 0.03 m of a step.
        let x = -0.0005 * k as f32;
        for gap in [
            drive_until_contact(&cylinder, pose(x, 0.0, 0.0), 60),
            drive_until_contact(&slab, pose(x, 0.02, 0.0), 60),
            drive_until_contact(&Scenario::default(), pose(1.0 + x, 0.3, 0.0), 60),
            drive_until_contact(&Scenario::default(), pose(0.9 + x, 0.9, PI / 4.0), 90),
        ] {
            worst = worst.min(gap);
        }
    }
    assert!(worst > -0.001, "the robot penetrates something by {} mm, more than 1 mm", -worst * 1e3);
}

#[test]
fn no_episode_continues_with_a_range_below_the_collision_range_or_in_contact() {
    let scenario = common::moving_obstacles();
    let mut lab = Lab::new(&scenario, 32, 2);
    let mut action_streams = common::action_streams(32);
    let mut collisions = 0;
    for _ in 0..600 {
        let before = lab.states();
        let actions = common::random_actions(&mut action_streams);
        lab.step(&actions);
        for (arena, outcome) in lab.outcomes().iter().enumerate() {
            collisions += usize::from(outcome.collided);
            assert!(
                before[arena].scan.nearest_m >= scenario.task.collision_range_m,
                "arena {arena}: no episode continues with a range below the collision range"
            );
        }
        for state in lab.states() {
            assert!(!state.scan.touching, "no episode continues in contact");
        }
    }
    assert!(collisions > 100, "{collisions}");
}

/// The ranges from casting every beam against every shape. [`lidar::cast`] skips most casts and must give the same bits.
fn cast_every_beam(
    colliders: &ColliderSet,
    solids: &[ColliderHandle],
    from: &Pose,
    beams: &[Vec2],
    max_m: f32,
) -> Vec<f32> {
    let (sin, cos) = libm::sincosf(from.heading_rad);
    let mut ranges = vec![max_m; beams.len()];
    for collider in solids.iter().map(|&handle| &colliders[handle]) {
        let placed = collider.position();
        let origin = placed.inverse_transform_point(Vec2::new(from.x_m, from.y_m));
        let heading = placed.inverse_transform_vector(Vec2::new(cos, sin));
        for (beam, range) in beams.iter().zip(&mut ranges) {
            let ray = Ray::new(origin, heading.rotate(*beam));
            *range = collider.shape().cast_local_ray(&ray, *range, true).unwrap_or(*range);
        }
    }
    ranges
}

/// Discs and rotated boxes from 1 mm to 5 m, some at round coordinates, so that beams run along their sides.
fn any_solid() -> impl Strategy<Value = ColliderBuilder> {
    let size = || prop_oneof![(-3.0_f32..0.7).prop_map(|power| 10.0_f32.powf(power)), Just(0.25)];
    let coordinate = || prop_oneof![-4.0_f32..4.0, (-8_i8..8).prop_map(|k| 0.5 * f32::from(k))];
    let turn = prop_oneof![-PI..PI, Just(0.0)];
    (any::<bool>(), size(), size(), coordinate(), coordinate(), turn).prop_map(|(disc, a, b, x, y, turn)| {
        let solid = if disc { ColliderBuilder::ball(a) } else { ColliderBuilder::cuboid(a, b) };
        solid.translation(Vector::new(x, y)).rotation(turn)
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    #[test]
    fn skipping_casts_changes_no_bit(
        scene in prop::collection::vec(any_solid(), 1..9),
        near in prop::option::of(0_usize..9), dx in -4.0_f32..4.0, dy in -4.0_f32..4.0, shrink in 0_i32..7,
        heading in prop_oneof![-PI..PI, (-4_i8..=4).prop_map(|k| f32::from(k) * PI / 4.0)],
        count in prop_oneof![Just(24_usize), 1_usize..200], max_m in prop_oneof![Just(3.5_f32), 0.05_f32..50.0],
    ) {
        let mut colliders = ColliderSet::new();
        let solids: Vec<_> = scene.into_iter().map(|solid| colliders.insert(solid)).collect();
        // Anywhere, or near one of the shapes: at its boundary, inside it, or at its centre.
        let middle = near.map_or(Vec2::ZERO, |k| colliders[solids[k % solids.len()]].translation());
        let scale = if shrink == 6 { 0.0 } else { 0.2_f32.powi(shrink) };
        let from = pose(middle.x + dx * scale, middle.y + dy * scale, heading);
        let beams = Lidar { beams: count, ..Lidar::default() }.beam_directions();
        let mut ranges = Vec::new();
        lidar::cast(&colliders, &solids, &from, &beams, max_m, &mut ranges);
        prop_assert_eq!(bits(&ranges), bits(&cast_every_beam(&colliders, &solids, &from, &beams, max_m)));
    }
}
