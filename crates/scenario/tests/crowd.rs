//! Pedestrians: they reach their goals and avoid each other, walls, obstacles and, if they see it, the robot.

use wayfield_scenario::{
    Crowd, IndexedScenario, Obstacle, ObstacleMotion, Scenario, Shape, Vec2, Wall, diagnostics, notes, vec2,
};

const RADIUS_M: f32 = 0.2;
/// Position and velocity of a robot far from all pedestrians, at rest.
const NO_ROBOT: (Vec2, Vec2) = (vec2(100.0, 100.0), Vec2::ZERO);

fn pedestrian(position_m: Vec2, goals_m: &[Vec2], loops: bool, sees_robot: bool) -> Obstacle {
    Obstacle {
        shape: Shape::Circle { radius_m: RADIUS_M },
        position_m,
        rotation_rad: 0.0,
        motion: ObstacleMotion::Pedestrian {
            goals_m: goals_m.into(),
            speed_m_s: 0.5.into(),
            loops,
            sees_robot,
        },
    }
}

fn post(position_m: Vec2) -> Obstacle {
    let shape = Shape::Circle { radius_m: RADIUS_M };
    Obstacle { shape, position_m, rotation_rad: 0.0, motion: ObstacleMotion::Static }
}

fn scenario(obstacles: Vec<Obstacle>) -> Scenario {
    let enclosure = wayfield_scenario::Enclosure::Rectangle { width_m: 8.0, height_m: 8.0 };
    Scenario { enclosure, obstacles, ..Scenario::default() }
}

/// The positions of all obstacles after 0 to `steps` control steps.
fn walk(scenario: &Scenario, robot: (Vec2, Vec2), steps: usize) -> Vec<Vec<Vec2>> {
    let mut crowd = Crowd::at_start(scenario);
    let mut positions = || {
        let space = IndexedScenario { crowd: Some(&crowd), ..scenario.into() };
        let at = |index| {
            let (x, y, _) = space.pose_at(index, 0);
            vec2(x, y)
        };
        let now = (0..scenario.obstacles.len()).map(at).collect();
        crowd.advance(scenario, robot);
        now
    };
    (0..=steps).map(|_| positions()).collect()
}

/// The least distance in m between any two obstacles, or between one of them and `point`, at any step of the `walk`.
fn least_distance_m(walk: &[Vec<Vec2>], point: Option<Vec2>) -> f32 {
    let at = |now: &Vec<Vec2>| {
        let others = |k: usize| now[k + 1..].iter().chain(&point);
        let pairs = (0..now.len()).flat_map(|k| others(k).map(move |other| now[k].distance(*other)));
        pairs.fold(f32::INFINITY, f32::min)
    };
    walk.iter().map(at).fold(f32::INFINITY, f32::min)
}

#[test]
fn pedestrians_who_meet_pass_each_other_and_return_without_touching() {
    let (left, right) = (vec2(-2.0, 0.02), vec2(2.0, 0.0));
    let scenario =
        scenario(vec![pedestrian(left, &[right], true, false), pedestrian(right, &[left], true, false)]);
    let walk = walk(&scenario, NO_ROBOT, 130);
    assert!(least_distance_m(&walk, None) >= 2.0 * RADIUS_M, "{}", least_distance_m(&walk, None));
    let near = |k: usize, point: Vec2| walk.iter().position(|now| now[k].distance(point) < 0.25);
    // 4 m at 0.5 m/s take 8 s, or 40 steps.
    assert!(near(0, right).is_some_and(|step| (38..50).contains(&step)), "{:?}", near(0, right));
    assert!(near(1, left).is_some_and(|step| (38..50).contains(&step)), "{:?}", near(1, left));
    assert!(walk[50..].iter().any(|now| now[0].distance(left) < 0.25), "it has returned");
}

#[test]
fn a_pedestrian_visits_its_goals_in_order_and_stops_at_the_last_if_it_does_not_loop() {
    let goals = [vec2(1.0, 0.0), vec2(1.0, 1.0), vec2(-1.0, 1.0)];
    let scenario = scenario(vec![pedestrian(Vec2::ZERO, &goals, false, false)]);
    let walk = walk(&scenario, NO_ROBOT, 150);
    let reached =
        goals.map(|goal| walk.iter().position(|now| now[0].distance(goal) < 0.25).expect("reached"));
    assert!(reached.is_sorted(), "{reached:?}");
    assert!(walk[150][0].distance(goals[2]) < 0.01, "{}", walk[150][0]);
    let fastest = walk.windows(2).map(|ends| ends[0][0].distance(ends[1][0])).fold(0.0, f32::max);
    assert!((fastest - 0.1).abs() < 1e-5, "{fastest} m per step of 0.2 s at 0.5 m/s");
}

#[test]
fn a_robot_is_avoided_only_by_pedestrians_who_see_it() {
    let robot = (vec2(0.0, 0.05), Vec2::ZERO);
    let least_m = |sees_robot| {
        let scenario = scenario(vec![pedestrian(vec2(-2.0, 0.0), &[vec2(2.0, 0.0)], false, sees_robot)]);
        let walk = walk(&scenario, robot, 80);
        assert!(walk[80][0].distance(vec2(2.0, 0.0)) < 0.2, "it arrives: {}", walk[80][0]);
        least_distance_m(&walk, Some(robot.0))
    };
    let contact_m = RADIUS_M + Scenario::default().robot.radius_m;
    assert!(least_m(true) >= contact_m, "{}", least_m(true));
    assert!(least_m(false) < 0.1, "{}", least_m(false));
}

#[test]
fn pedestrians_keep_clear_of_walls_and_static_obstacles() {
    let walls =
        vec![Wall { corners_m: vec![vec2(-1.0, 0.4), vec2(1.0, 0.4)], thickness_m: 0.1, ..Wall::default() }];
    let goals = [vec2(0.0, 0.0), vec2(3.9, 0.0)];
    let obstacles = vec![pedestrian(vec2(-2.0, 0.8), &goals, true, false), post(vec2(-1.2, 0.45))];
    let scenario = Scenario { walls, ..scenario(obstacles) };
    let alone = Scenario { obstacles: vec![post(vec2(-1.2, 0.45))], ..scenario.clone() };
    for now in walk(&scenario, NO_ROBOT, 200) {
        let gap_m = wayfield_scenario::clearance(&alone, now[0], 0);
        assert!(gap_m >= RADIUS_M - 1e-3, "{gap_m} m at {}", now[0]);
    }
}

#[test]
fn a_crowd_on_a_circle_crosses_it_without_touching() {
    // Pedestrians at uneven intervals on the circle, each with its goal on the opposite side.
    let start = |k: u8| Vec2::from_angle(f32::from(k) * 0.6283 + 0.01 * f32::from(k * k)) * 3.0;
    let obstacles = (0..10).map(|k| pedestrian(start(k), &[-start(k)], false, false)).collect();
    let scenario = scenario(obstacles);
    let walk = walk(&scenario, NO_ROBOT, 300);
    assert!(least_distance_m(&walk, None) >= 2.0 * RADIUS_M - 0.01, "{}", least_distance_m(&walk, None));
    for (k, at) in walk[300].iter().enumerate() {
        let goal = -start(k as u8);
        assert!(at.distance(goal) < 0.3, "pedestrian {k} is at {at}, not {goal}");
    }
}

#[test]
fn a_path_through_a_wall_is_noted_and_too_many_pedestrians_are_an_error() {
    let walls =
        vec![Wall { corners_m: vec![vec2(0.0, -1.0), vec2(0.0, 1.0)], thickness_m: 0.1, ..Wall::default() }];
    let one = pedestrian(vec2(-2.0, 0.0), &[vec2(2.0, 0.0)], true, false);
    let through = Scenario { walls, ..scenario(vec![one.clone()]) };
    let found: Vec<String> = notes(&through).iter().map(ToString::to_string).collect();
    let expected = "`obstacles[0].motion` crosses wall 1 (`walls[0]`) at (0.00, 0.00): pedestrians don't find a way around; \
                    add goals on the way";
    assert!(found.iter().any(|note| note.contains(expected)), "{found:?}");
    let crowded = scenario(vec![one; 201]);
    let found = diagnostics(&crowded);
    assert!(
        found.iter().any(|problem| problem.message == "contain 201 pedestrians: write at most 200"),
        "{found:?}"
    );
}

#[test]
fn a_moved_start_moves_the_pedestrian_and_a_changed_crowd_starts_again() {
    let one = pedestrian(vec2(-2.0, 0.0), &[vec2(2.0, 0.0)], true, false);
    let before = scenario(vec![post(vec2(3.0, 3.0)), one.clone()]);
    let mut crowd = Crowd::at_start(&before);
    (0..10).for_each(|_| crowd.advance(&before, NO_ROBOT));
    let mut after = before.clone();
    after.obstacles[1].position_m.y += 0.5;
    let was_m = crowd.pedestrian(1).expect("a pedestrian").position_m;
    crowd.follow_change(&before, &after);
    assert_eq!(crowd.pedestrian(1).expect("a pedestrian").position_m, was_m + vec2(0.0, 0.5));
    let others = scenario(vec![one]);
    crowd.follow_change(&after, &others);
    assert_eq!(crowd, Crowd::at_start(&others));
    assert!(!crowd.fits(&after), "its pedestrian is obstacle 0, not 1");
}
