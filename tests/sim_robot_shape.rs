//! Robots that are not discs: where they touch, and that they pass through nothing.

mod common;

use common::Lab;
use proptest::prelude::*;
use wayfield::scenario::{
    Motion, Obstacle, ObstacleMotion, Robot, Scenario, Shape, TaskRules, Vec2, Wall, pose_at, vec2,
};
use wayfield::task::{DeferResets, Pose, wrap_angle};

/// The tolerance of a contact, in m: the gap below which bodies touch, and the resolution of the search for the contact.
const CONTACT_M: f32 = 0.0007;

fn pose(x_m: f32, y_m: f32, heading_rad: f32) -> Pose {
    Pose { x_m, y_m, heading_rad }
}

/// The default enclosure of 4 m x 4 m with a robot of this shape and one motion. The collision range is too short to count.
fn scenario(shape: Shape, v_m_s: f32, w_rad_s: f32) -> Scenario {
    Scenario {
        robot: Robot { shape: Some(shape), motions: vec![Motion { v_m_s, w_rad_s }], ..Robot::default() },
        task: TaskRules { collision_range_m: 0.01, ..TaskRules::default() },
        ..Scenario::default()
    }
}

/// Drives a robot from `start` until it touches something, and returns its poses.
fn drive_until_contact(scenario: &Scenario, start: Pose) -> Vec<Pose> {
    let mut lab = Lab::new(scenario, 1, 1);
    lab.edit(0, |state| {
        state.pose = start;
        (state.goal.x_m, state.goal.y_m) = (-1.9, -1.9);
    });
    // Keeps the pose at the end of the episode; a reset would replace it with the next start.
    lab.simulation.world_mut().insert_resource(DeferResets(true));
    let mut poses = vec![start];
    for _ in 0..200 {
        let before = lab.state(0).episode.steps;
        assert_eq!(before as usize, poses.len() - 1, "one episode");
        lab.step(&[0]);
        poses.push(lab.state(0).pose);
        if lab.outcomes()[0].collided {
            return poses;
        }
    }
    panic!("no contact in 200 steps: {poses:?}");
}

#[test]
fn a_box_that_turns_on_the_spot_stops_where_its_corner_touches_the_wall() {
    // 0.5 m x 0.2 m, its middle 0.15 m below the upper wall: a corner is 0.25 sin(a) + 0.1 cos(a) above the middle.
    let mut turning = scenario(Shape::Rectangle { width_m: 0.5, height_m: 0.2 }, 0.0, 0.8);
    // At least one motion must move the robot; this one is not used.
    turning.robot.motions.push(Motion { v_m_s: 0.1, w_rad_s: 0.0 });
    let end = *drive_until_contact(&turning, pose(0.3, 1.85, 0.0)).last().unwrap();
    let height = 0.25 * end.heading_rad.sin() + 0.1 * end.heading_rad.cos();
    assert!((0.15 - height).abs() <= CONTACT_M && height < 0.15, "the corner is {height} m above the middle");
    assert!((end.x_m - 0.3).hypot(end.y_m - 1.85) < 1e-6, "it turns on the spot: {end:?}");
    assert!(end.heading_rad > 0.2 && end.heading_rad < 0.25, "0.15 = 0.25 sin(a) + 0.1 cos(a): {end:?}");
}

#[test]
fn a_long_robot_passes_a_gap_that_is_narrower_than_it_is_long() {
    let wall = |from, to| Wall {
        corners_m: vec![vec2(0.0, from), vec2(0.0, to)],
        thickness_m: 0.1,
        ..Wall::default()
    };
    // The gap is 0.3 m wide.
    let mut gap = scenario(Shape::Rectangle { width_m: 0.8, height_m: 0.28 }, 0.15, 0.0);
    gap.walls = vec![wall(-2.0, -0.2), wall(0.2, 2.0)];
    let through = drive_until_contact(&gap, pose(-1.0, 0.0, 0.0));
    let front = through.last().unwrap().x_m + 0.4;
    assert!((front - 2.0).abs() <= CONTACT_M, "it touches the enclosure with its front at {front} m");
    // Crosswise it is too wide.
    let mut crosswise = gap.clone();
    crosswise.robot.shape = Some(Shape::Rectangle { width_m: 0.28, height_m: 0.8 });
    let front = drive_until_contact(&crosswise, pose(-1.0, 0.0, 0.0)).last().unwrap().x_m + 0.14;
    assert!((front + 0.05).abs() <= CONTACT_M, "it touches the wall with its front at {front} m");
}

#[test]
fn the_collision_range_counts_where_it_reaches_farther_than_the_body() {
    let mut scenario = scenario(Shape::Rectangle { width_m: 0.5, height_m: 0.2 }, 0.15, 0.0);
    // Along the upper wall, 0.12 m from the middle: a collision range of 0.13 m reaches it.
    let along = |collision_range_m: f32, scenario: &mut Scenario| {
        scenario.task.collision_range_m = collision_range_m;
        drive_until_contact(scenario, pose(0.0, 1.88, 0.0)).len()
    };
    assert_eq!(along(0.13, &mut scenario), 2, "at the end of the first step");
    assert!(along(0.11, &mut scenario) > 50, "at the wall ahead");
}

/// A box, polygons about an origin that is not their middle, and a capsule.
fn shapes() -> impl Strategy<Value = Shape> {
    let waffle = vec![vec2(0.077, 0.155), vec2(-0.205, 0.155), vec2(-0.205, -0.155), vec2(0.077, -0.155)];
    let wedge = vec![vec2(0.4, 0.0), vec2(-0.1, 0.12), vec2(-0.1, -0.12)];
    prop_oneof![
        Just(Shape::Rectangle { width_m: 0.508, height_m: 0.43 }),
        Just(Shape::Polygon { corners_m: waffle }),
        Just(Shape::Polygon { corners_m: wedge }),
        Just(Shape::Capsule { length_m: 0.4, radius_m: 0.1 }),
    ]
}

/// Obstacles of every shape, at rest and moving.
fn obstacles() -> impl Strategy<Value = Vec<Obstacle>> {
    let shape = prop_oneof![
        Just(Shape::Circle { radius_m: 0.15 }),
        Just(Shape::Rectangle { width_m: 0.4, height_m: 0.05 }),
        Just(Shape::Capsule { length_m: 0.3, radius_m: 0.05 }),
        Just(Shape::Polygon { corners_m: vec![vec2(0.2, 0.0), vec2(-0.1, 0.15), vec2(-0.1, -0.15)] }),
    ];
    let place = || (-1.5_f32..1.5, -1.5_f32..1.5).prop_map(Vec2::from);
    let motion = prop_oneof![
        Just(ObstacleMotion::Static),
        place().prop_map(|to| ObstacleMotion::BackAndForth { waypoints_m: vec![to], speed_m_s: 0.5.into() }),
        place().prop_map(|centre_m| ObstacleMotion::Orbit { centre_m, speed_rad_s: 0.4.into() }),
    ];
    let one =
        (shape, place(), -3.0_f32..3.0, motion).prop_map(|(shape, position_m, rotation_rad, motion)| {
            Obstacle { shape, position_m, rotation_rad, motion }
        });
    proptest::collection::vec(one, 1..6)
}

/// The scenario with its obstacles at a fraction of the way from their poses at `step` to those one step later.
fn between_steps(scenario: &Scenario, step: u64, fraction: f32) -> Scenario {
    let mut still = scenario.clone();
    let period_s = scenario.task.control_period_s;
    for (obstacle, moving) in still.obstacles.iter_mut().zip(&scenario.obstacles) {
        let (from, to) = (pose_at(moving, step, period_s), pose_at(moving, step + 1, period_s));
        let (from_m, to_m) = (vec2(from.0, from.1), vec2(to.0, to.1));
        let turned_rad = wrap_angle(to.2 - from.2) * fraction;
        obstacle.position_m = match moving.motion {
            ObstacleMotion::Orbit { centre_m, .. } => {
                centre_m + Vec2::from_angle(turned_rad).rotate(from_m - centre_m)
            }
            _ => from_m.lerp(to_m, fraction),
        };
        obstacle.rotation_rad = from.2 + turned_rad;
        obstacle.motion = ObstacleMotion::Static;
    }
    still
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 150, ..ProptestConfig::default() })]

    /// The robot stops where it first touches something, even in the middle of a step. In a step, it moves along the chord
    /// of its arc while its heading changes at constant speed.
    #[test]
    fn a_robot_stops_at_its_first_contact_and_overlaps_nothing_before(
        shape in shapes(),
        obstacles in obstacles(),
        start in (-1.3_f32..1.3, -1.3_f32..1.3, -3.0_f32..3.0),
        (v_m_s, w_rad_s, is_right) in (-1.0_f32..1.0, 0.3_f32..4.0, any::<bool>()),
    ) {
        let w_rad_s = if is_right { -w_rad_s } else { w_rad_s };
        let mut scenario = scenario(shape, v_m_s, w_rad_s);
        scenario.obstacles = obstacles;
        prop_assume!(scenario.nearest_to_body(start, 0).1 > 0.01);
        let mut lab = Lab::new(&scenario, 1, 1);
        let clock = lab.state(0).clock.0;
        lab.edit(0, |state| {
            state.pose = pose(start.0, start.1, start.2);
            (state.goal.x_m, state.goal.y_m) = (-1.9, -1.9);
        });
        lab.simulation.world_mut().insert_resource(DeferResets(true));
        for step in clock.. {
            let from = lab.state(0).pose;
            lab.step(&[0]);
            let to = lab.state(0).pose;
            let touches = lab.state(0).scan.touching;
            let turn = wrap_angle(to.heading_rad - from.heading_rad);
            let whole = w_rad_s * 0.2;
            // The heading changes at constant speed, so the turn shows what fraction of the step was made.
            let made = if touches { (turn / whole).clamp(0.0, 1.0) } else { 1.0 };
            for k in 0..=20_u8 {
                let part = f32::from(k) / 20.0;
                let (x, y) = (from.x_m + (to.x_m - from.x_m) * part, from.y_m + (to.y_m - from.y_m) * part);
                let at = (x, y, from.heading_rad + turn * part);
                let (solid, gap_m) = between_steps(&scenario, step, made * part).nearest_to_body(at, 0);
                prop_assert!(gap_m > 0.0, "in step {step} at {part}: overlaps {solid:?}");
                if touches && k == 20 {
                    prop_assert!(gap_m < 0.002, "it stops {gap_m} m before it touches {solid:?}");
                }
            }
            let outcome = lab.outcomes()[0];
            if outcome.collided || outcome.reached || step > clock + 60 {
                break;
            }
            prop_assert!(!touches, "a contact is a collision");
            prop_assert!((turn - wrap_angle(whole)).abs() < 1e-5, "it turns as commanded");
        }
    }
}
