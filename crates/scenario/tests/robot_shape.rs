//! Robots that are not discs, and robots with car-like steering: what a file may contain, the space they need, and the distance
//! of their body from surfaces.

use std::f32::consts::{FRAC_PI_4, PI};

use glam::{Vec2, vec2};
use wayfield_scenario::{
    Enclosure, Motion, Obstacle, ObstacleMotion, PlacementRule, Robot, Scenario, Shape, Solid, TaskRules,
    Wall, convex_distance, diagnostics, parse_ron, to_text,
};

/// A TurtleBot3 Waffle: 282 mm x 310 mm; its wheels are 64 mm ahead of the middle.
fn waffle() -> Shape {
    let corners = [(0.077, 0.155), (-0.205, 0.155), (-0.205, -0.155), (0.077, -0.155)];
    Shape::Polygon { corners_m: corners.into_iter().map(Vec2::from).collect() }
}

fn with_shape(shape: Shape) -> Scenario {
    Scenario { robot: Robot { shape: Some(shape), ..Robot::default() }, ..Scenario::default() }
}

fn found(scenario: &Scenario) -> Vec<String> {
    diagnostics(scenario).iter().map(ToString::to_string).collect()
}

#[test]
fn a_shape_is_read_and_written_and_a_disc_has_none() {
    let text = "(name: \"Mine\", robot: (shape: Rectangle(width_m: 0.508, height_m: 0.43)))";
    let jackal: Scenario = parse_ron(text, "w.ron").expect("RON");
    assert_eq!(jackal.robot.shape, Some(Shape::Rectangle { width_m: 0.508, height_m: 0.43 }));
    let written = to_text(&jackal, Some(text));
    assert_eq!(parse_ron::<Scenario>(&written, "w.ron").expect("RON"), jackal);
    let disc = Scenario { robot: Robot { radius_m: 0.12, ..Robot::default() }, ..Scenario::default() };
    let written = to_text(&disc, None);
    assert!(written.contains("robot: (radius_m: 0.12)"), "{written}");
    let no_longer = to_text(&disc, Some(text));
    assert!(
        no_longer.contains("radius_m: 0.12") && !no_longer.contains("Rectangle(width_m: 0.5"),
        "{no_longer}"
    );
}

#[test]
fn a_shape_must_contain_the_robots_origin_and_have_sizes_in_range() {
    let corners =
        |corners: &[(f32, f32)]| Shape::Polygon { corners_m: corners.iter().map(|&at| at.into()).collect() };
    let inside = "`robot.shape` does not extend 0.01 m around its origin, where the LIDAR is: make it wider, or move its corners";
    for (shape, expected) in [
        (Shape::Circle { radius_m: 0.2 }, "`robot.shape` is a circle: write `radius_m: 0.2` instead"),
        (corners(&[(0.1, 0.1), (0.3, 0.1), (0.2, 0.3)]), inside),
        (corners(&[(0.005, -0.1), (0.005, 0.1), (-0.2, 0.0)]), inside),
        (Shape::Rectangle { width_m: 0.2, height_m: 0.015 }, inside),
        (
            Shape::Rectangle { width_m: 20.0, height_m: 2.0 },
            "`robot.shape` reaches 10.050 m from its origin: make it at most 10 m",
        ),
        (
            Shape::Rectangle { width_m: 0.0, height_m: 0.2 },
            "`robot.shape.width_m` is 0: write a number from 0.001 to 1000 (metres)",
        ),
        (
            corners(&[(0.2, 0.2), (-0.2, 0.2), (-0.05, 0.0), (-0.2, -0.2), (0.2, -0.2)]),
            "`robot.shape.corners_m[2]` is a concave corner: move it outwards, remove it, or build the outline from several \
             obstacles",
        ),
    ] {
        assert_eq!(
            found(&with_shape(shape.clone())).first().map(String::as_str),
            Some(expected),
            "{shape:?}"
        );
    }
    let mut both = with_shape(waffle());
    assert_eq!(found(&both), Vec::<String>::new());
    both.robot.radius_m = 0.2;
    assert_eq!(found(&both), ["`robot.radius_m` has no effect on a robot with a `shape`: remove it"]);
}

#[test]
fn starts_goals_and_gaps_leave_space_for_the_robot_at_any_heading() {
    let reach_m = 0.205_f32.hypot(0.155);
    let mut tight = with_shape(waffle());
    assert!((tight.keep_out_m() - reach_m).abs() < 1e-6 && (tight.sure_collision_m() - 0.13).abs() < 1e-6);
    tight.task.collision_range_m = 0.05;
    assert!((tight.sure_collision_m() - 0.077).abs() < 1e-6, "the nearest edge is ahead");
    tight.starts = PlacementRule::Random { clearance_m: 0.25 };
    let text = format!("write more than the reach of the robot's shape, {} m", tight.robot.reach_m());
    assert_eq!(found(&tight), [format!("`starts.clearance_m` is 0.25: {text}")]);
    tight.starts = PlacementRule::Fixed { position_m: vec2(1.75, 0.0), heading_rad: None };
    let message = &found(&tight)[0];
    assert!(
        message.starts_with("`starts.position_m` is 0.250 m from the wall of the enclosure: "),
        "{message}"
    );
    tight.starts = PlacementRule::Fixed { position_m: vec2(1.74, 0.0), heading_rad: None };
    assert_eq!(found(&tight), Vec::<String>::new());
}

#[test]
fn a_goal_is_out_of_reach_only_if_no_heading_fits_through_the_gap() {
    // A robot of 0.6 m x 0.3 m, and a wall with one gap across the enclosure.
    let behind = |gap_m: f32| {
        let walls = [(-2.0, -gap_m / 2.0 - 0.05), (gap_m / 2.0 + 0.05, 2.0)];
        let wall = |(from, to)| Wall {
            corners_m: vec![vec2(0.0, from), vec2(0.0, to)],
            thickness_m: 0.1,
            ..Wall::default()
        };
        let fixed = |x: f32| PlacementRule::Fixed { position_m: vec2(x, 0.0), heading_rad: None };
        Scenario {
            walls: walls.into_iter().map(wall).collect(),
            starts: fixed(-1.0),
            goals: fixed(1.0),
            task: TaskRules { collision_range_m: 0.05, ..TaskRules::default() },
            ..with_shape(Shape::Rectangle { width_m: 0.6, height_m: 0.3 })
        }
    };
    assert_eq!(found(&behind(0.4)), Vec::<String>::new(), "lengthwise it fits");
    let messages = found(&behind(0.2));
    let reason =
        "the robot needs a gap of more than 0.30 m, twice the distance from its origin to its nearest edge";
    assert!(messages.len() == 1 && messages[0].contains(reason), "{messages:?}");
}

#[test]
fn the_distance_of_two_convex_shapes_is_that_of_their_nearest_points() {
    let square = |x: f32, y: f32, half: f32| {
        [
            vec2(x - half, y - half),
            vec2(x + half, y - half),
            vec2(x + half, y + half),
            vec2(x - half, y + half),
        ]
    };
    let one = square(0.0, 0.0, 1.0);
    for (other, expected) in [
        (&square(3.0, 0.0, 1.0)[..], 1.0),
        (&square(4.0, 5.0, 1.0), 2.0_f32.hypot(3.0)),
        (&square(0.2, 0.1, 0.3), 0.0),
        (&square(0.0, 0.0, 5.0), 0.0),
        (&square(1.5, 1.5, 0.6), 0.0),
        (&[vec2(-3.0, 0.0), vec2(3.0, 0.2)], 0.0),
        (&[vec2(1.5, -3.0), vec2(1.5, 3.0)], 0.5),
        (&[vec2(2.0, 2.0)], 2.0_f32.sqrt()),
        (&[vec2(0.5, 0.5)], 0.0),
    ] {
        for (a, b) in [(&one[..], other), (other, &one[..])] {
            let found = convex_distance(a, b);
            assert!((found - expected).abs() < 1e-6, "{a:?} and {b:?}: {found}, not {expected}");
        }
    }
}

#[test]
fn the_body_is_as_far_from_everything_as_its_nearest_point() {
    let still = |shape, position_m, rotation_rad| Obstacle {
        shape,
        position_m,
        rotation_rad,
        motion: ObstacleMotion::Static,
    };
    let l = [(-2.0, -2.0), (2.0, -2.0), (2.0, 0.0), (0.0, 0.0), (0.0, 2.0), (-2.0, 2.0)];
    let mut scenario = Scenario {
        enclosure: Enclosure::Polygon { corners_m: l.into_iter().map(Vec2::from).collect() },
        walls: vec![Wall {
            corners_m: vec![vec2(-1.0, -2.0), vec2(-1.0, -1.4)],
            thickness_m: 0.1,
            ..Wall::default()
        }],
        obstacles: vec![
            still(Shape::Capsule { length_m: 0.4, radius_m: 0.1 }, vec2(-1.5, 1.0), 0.3),
            still(Shape::Circle { radius_m: 0.2 }, vec2(1.2, -1.2), 0.0),
            still(Shape::Rectangle { width_m: 0.3, height_m: 0.5 }, vec2(0.6, -0.8), 0.8),
        ],
        ..with_shape(waffle())
    };
    // Turned by an eighth of a turn, the box faces the enclosure's reflex corner at (0, 0).
    scenario.robot.shape = Some(Shape::Rectangle { width_m: 0.6, height_m: 0.4 });
    let (solid, distance) =
        scenario.nearest_to_body((-0.3 * 2.0_f32.sqrt(), -0.3 * 2.0_f32.sqrt(), FRAC_PI_4), 0);
    assert_eq!(solid, Solid::Enclosure);
    assert!((distance - 0.3).abs() < 1e-5, "from the side to the inner corner: {distance}");

    let mut nearest = [0; 3];
    for shape in [waffle(), Shape::Capsule { length_m: 0.3, radius_m: 0.12 }] {
        scenario.robot.shape = Some(shape.clone());
        for k in 0..600_u16 {
            let (a, b) = (f32::from(k) * 0.618_034 % 1.0, f32::from(k) * 0.754_878 % 1.0);
            let (x, y, heading) = (-2.0 + 4.0 * a, -2.0 + 4.0 * b, PI * (f32::from(k) * 0.569_84 % 1.0));
            let (solid, distance) = scenario.nearest_to_body((x, y, heading), 0);
            // The least signed clearance of points all over the body.
            let sampled = body_points(&shape, (x, y, heading))
                .map(|point| wayfield_scenario::clearance(&scenario, point, 0))
                .fold(f32::INFINITY, f32::min);
            assert!((distance - sampled.max(0.0)).abs() < 0.015, "at {x}, {y}: {distance}, not {sampled}");
            nearest[match solid {
                Solid::Enclosure => 0,
                Solid::Wall(_) => 1,
                Solid::Obstacle(_) => 2,
            }] += 1;
        }
    }
    assert!(nearest.iter().all(|&count| count > 20), "each kind is the nearest at times: {nearest:?}");
}

/// The points of a grid of 0.01 m that are in a shape at a pose.
fn body_points(shape: &Shape, (x, y, heading): (f32, f32, f32)) -> impl Iterator<Item = Vec2> {
    let (sin, cos) = heading.sin_cos();
    let grid =
        (-30_i8..=30).flat_map(|i| (-30_i8..=30).map(move |j| vec2(f32::from(i), f32::from(j)) * 0.01));
    grid.filter(|&point| shape.distance(point) <= 0.0)
        .map(move |p| vec2(x + p.x * cos - p.y * sin, y + p.x * sin + p.y * cos))
}

#[test]
fn the_motions_of_a_car_keep_its_minimum_turning_radius() {
    let motion = |v_m_s, w_rad_s| Motion { v_m_s, w_rad_s };
    let car = |motions: &[Motion], radius_m: f32| Scenario {
        robot: Robot { min_turning_radius_m: Some(radius_m), motions: motions.into(), ..Robot::default() },
        ..Scenario::default()
    };
    let fits = [motion(0.3, 0.6), motion(-0.3, 0.6), motion(0.3, -0.3), motion(0.0, 0.0)];
    assert_eq!(found(&car(&fits, 0.5)), Vec::<String>::new());
    let tight = [motion(0.3, 0.0), motion(0.2, -0.5), motion(0.0, 0.5)];
    assert_eq!(
        found(&car(&tight, 0.5)),
        [
            "`robot.motions[1]` turns with a radius of 0.400 m, but the robot's minimum turning radius is 0.5 m: write a w_rad_s \
             of at most 0.400 either way, or a larger v_m_s",
            "`robot.motions[2]` turns on the spot, but the robot's minimum turning radius is 0.5 m: write a w_rad_s of 0 or a \
             larger v_m_s, or remove min_turning_radius_m",
        ]
    );
    let message = &found(&car(&fits, 0.0))[0];
    assert_eq!(message, "`robot.min_turning_radius_m` is 0: write a number from 0.001 to 100 (metres)");

    let robot = car(&fits, 0.5).robot;
    for (wanted, steered) in [
        (motion(0.2, 1.0), motion(0.2, 0.4)),
        (motion(-0.2, -1.0), motion(-0.2, -0.4)),
        (motion(0.2, 0.1), motion(0.2, 0.1)),
        (motion(0.0, 1.0), motion(0.0, 0.0)),
    ] {
        assert_eq!(robot.steerable(wanted), steered);
    }
    assert_eq!(Robot::default().steerable(motion(0.0, 1.0)), motion(0.0, 1.0), "a differential drive");
}
