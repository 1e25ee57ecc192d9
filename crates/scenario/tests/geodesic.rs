//! Shortest paths around walls and static obstacles: lengths worked out by hand, and no jumps between neighbouring points.

use std::path::Path;
use std::sync::Arc;

use glam::{Vec2, vec2};
use wayfield_random::{stream, uniform};
use wayfield_scenario::{
    Enclosure, FreeCells, Geodesic, LevelGenerator, Obstacle, ObstacleMotion, Scenario, Shape, Wall,
    clearance, draw_start_and_goal, read_ron,
};

/// The distance that the default robot keeps: its collision range.
const KEPT_M: f32 = 0.13;

fn scenario(walls: &[&[Vec2]]) -> Scenario {
    let wall = |corners: &&[Vec2]| Wall { corners_m: corners.to_vec(), thickness_m: 0.1, ..Wall::default() };
    Scenario { walls: walls.iter().map(wall).collect(), ..Scenario::default() }
}

fn length_m(scenario: &Scenario, from_m: Vec2, goal_m: Vec2) -> f32 {
    Geodesic::default().distance_m(&Arc::new(FreeCells::new(scenario)), goal_m, from_m)
}

/// The length in m of the path from a point to the top of the circle around `corner`, whose radius is the distance that the robot
/// keeps: a tangent and an arc.
fn past_corner_m(from: Vec2, corner: Vec2) -> f32 {
    let offset = from - corner;
    let tangent = (offset.length_squared() - KEPT_M * KEPT_M).sqrt();
    let angle = offset.angle_to(Vec2::Y).abs() - (KEPT_M / offset.length()).acos();
    tangent + KEPT_M * angle
}

fn assert_near(length_m: f32, expected_m: f32) {
    // The side of a cell.
    assert!((length_m - expected_m).abs() < 0.0975, "{length_m} m, by hand {expected_m} m");
}

#[test]
fn in_open_space_and_beside_an_obstacle_the_path_is_straight() {
    let mut open = scenario(&[]);
    let circle = |radius_m, position_m| Obstacle {
        shape: Shape::Circle { radius_m },
        position_m,
        rotation_rad: 0.0,
        motion: ObstacleMotion::Static,
    };
    open.obstacles.push(circle(0.3, vec2(0.0, 0.0)));
    let mut moving = circle(0.5, vec2(1.0, -1.4));
    moving.motion = ObstacleMotion::Orbit { centre_m: vec2(1.0, -1.3), speed_rad_s: 0.5.into() };
    open.obstacles.push(moving);
    let goal = vec2(1.2, 1.2);
    for from in [vec2(-1.2, 1.2), vec2(1.3, -1.5), vec2(-0.9, 0.5), vec2(1.25, 1.2), goal] {
        let offset = goal - from;
        assert_eq!(length_m(&open, from, goal), libm::hypotf(offset.x, offset.y), "{from}");
    }
    // Around the circle, with the distance that the robot keeps: two tangents and an arc.
    let (from, radius) = (vec2(-1.2, -1.2), 0.43_f32);
    let tangent = (from.length_squared() - radius * radius).sqrt();
    let arc = std::f32::consts::PI - 2.0 * (radius / from.length()).acos();
    assert_near(length_m(&open, from, goal), 2.0 * tangent + arc * radius);
}

#[test]
fn a_path_through_a_door_has_the_length_worked_out_by_hand() {
    let door = scenario(&[&[vec2(0.0, -2.0), vec2(0.0, 0.95)]]);
    for (from, goal) in [(vec2(-1.0, 0.0), vec2(1.0, 0.0)), (vec2(-0.5, -1.5), vec2(1.5, 0.5))] {
        let (left, right) = (past_corner_m(from, vec2(-0.05, 1.0)), past_corner_m(goal, vec2(0.05, 1.0)));
        assert_near(length_m(&door, from, goal), left + 0.1 + right);
        assert_near(length_m(&door, goal, from), left + 0.1 + right);
    }
}

#[test]
fn a_path_out_of_a_u_leads_around_its_end() {
    // A U that is open to the left: from inside, the goal behind its bottom is 1.5 m away.
    let (upper, lower) = (vec2(-0.5, 0.5), vec2(-0.5, -0.8));
    let u = scenario(&[&[upper, vec2(0.5, 0.5), vec2(0.5, -0.8), lower]]);
    let (from, goal) = (vec2(0.0, 0.0), vec2(1.5, 0.0));
    // The upper wall ends at x = -0.55, half its thickness beyond its corner, and there extends from y = 0.45 to 0.55. Turned so
    // that left is up, the path passes above both corners of this end, then along the upper side to the corner at (0.55, 0.55).
    let turned = |at: Vec2| vec2(at.y, -at.x);
    let out = past_corner_m(turned(from), turned(vec2(-0.55, 0.45)));
    let around = 0.1 + KEPT_M * std::f32::consts::FRAC_PI_2;
    let along = 1.1 + past_corner_m(goal, vec2(0.55, 0.55));
    assert_near(length_m(&u, from, goal), out + around + along);
}

#[test]
fn a_gap_too_narrow_for_the_robot_is_no_passage_and_a_closed_room_is_reached_through_its_wall() {
    let with_gap = |gap_m: f32| {
        let (left, right) = (-gap_m / 2.0 - 0.05, gap_m / 2.0 + 0.05);
        let walls: &[&[Vec2]] = &[&[vec2(-2.0, 0.0), vec2(left, 0.0)], &[vec2(right, 0.0), vec2(1.0, 0.0)]];
        length_m(&scenario(walls), vec2(0.0, -0.5), vec2(0.0, 0.5))
    };
    assert_near(with_gap(0.32), 1.0);
    assert!(with_gap(0.2) > 2.3, "around the right wall: {} m", with_gap(0.2));
    let closed = scenario(&[&[vec2(-2.0, 0.0), vec2(2.0, 0.0)]]);
    assert_near(length_m(&closed, vec2(0.3, -1.0), vec2(0.3, 1.0)), 2.0);
    // A robot that has no room anywhere.
    let mut full = scenario(&[]);
    full.robot.radius_m = 3.0;
    assert_eq!(length_m(&full, vec2(0.0, 0.0), vec2(0.6, 0.8)), 1.0);
}

/// Scenarios of `scenarios/`, and levels of `scenarios/generators/`.
fn shipped() -> Vec<Scenario> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut scenarios: Vec<Scenario> = ["u-trap", "doorway", "maze", "slalom", "corridor"]
        .map(|name| Scenario::load(root.join(format!("scenarios/{name}.ron"))).expect("shipped"))
        .into();
    for family in ["clutter", "rooms"] {
        let path = root.join(format!("scenarios/generators/{family}.ron"));
        let generator: LevelGenerator = read_ron(&path).expect("shipped");
        scenarios.extend((0..3).map(|seed| generator.level(seed).expect("a level")));
    }
    scenarios
}

#[test]
fn lengths_have_no_jumps_are_never_below_the_straight_distance_and_do_not_depend_on_earlier_queries() {
    let mut draws = stream(7, "geodesic", 0);
    for scenario in shipped() {
        let free = Arc::new(FreeCells::new(&scenario));
        let kept_m = scenario.sure_collision_m();
        let (low, high) = scenario.enclosure.bounds_m();
        let (_, goal) = draw_start_and_goal(&scenario, 0, &mut draws).expect("there is room");
        let (mut geodesic, mut steps) = (Geodesic::default(), 0);
        let step_m = 0.03;
        while steps < 3_000 {
            let from = vec2(uniform(&mut draws, low.x, high.x), uniform(&mut draws, low.y, high.y));
            let angle = uniform(&mut draws, -3.2, 3.2);
            let to = from + step_m * Vec2::from_angle(angle);
            if clearance(&scenario, from, 0) < kept_m || clearance(&scenario, to, 0) < kept_m {
                continue;
            }
            steps += 1;
            let lengths = [from, to].map(|at| geodesic.distance_m(&free, goal, at));
            assert!(lengths[0].is_finite() && lengths[0] >= from.distance(goal) - 1e-4);
            let change = (lengths[0] - lengths[1]).abs();
            assert!(
                change < 2.0 * step_m,
                "{}: {change} m in a step of {step_m} m from {from} to {to}, goal {goal}",
                scenario.name
            );
            if steps % 100 == 0 {
                let alone = Geodesic::default().distance_m(&free, goal, from);
                assert_eq!(alone.to_bits(), lengths[0].to_bits());
            }
        }
    }
}

#[test]
fn in_a_large_hall_with_coarser_cells_the_doors_stay_open() {
    let mut hall = scenario(&[&[vec2(0.0, -25.0), vec2(0.0, 23.9)]]);
    hall.enclosure = Enclosure::Rectangle { width_m: 50.0, height_m: 50.0 };
    let (from, goal) = (vec2(-5.0, 10.0), vec2(5.0, 10.0));
    let expected = 2.0 * past_corner_m(from, vec2(-0.05, 23.95)) + 0.1;
    assert!((length_m(&hall, from, goal) - expected).abs() < 0.3, "{} m", length_m(&hall, from, goal));
}
