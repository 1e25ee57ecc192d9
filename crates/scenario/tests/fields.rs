//! Tests of how shapes and motions describe themselves: their fields, tracks, speeds and outlines. The range checks, the editor
//! and all drawings use these.

use std::collections::BTreeSet;

use glam::{Vec2, vec2};
use wayfield_scenario::{
    FieldValue, MotionKind, MotionSpeed, Obstacle, ObstacleMotion, Outline, Ranged, Scenario, Shape, Track,
    diagnostics, polygon, pose_at, to_ron,
};

const PERIOD_S: f32 = 0.2;

/// A motion of every kind, for an obstacle at (0.5, 0.5).
fn motions() -> [ObstacleMotion; 7] {
    let waypoints_m = vec![vec2(1.0, 0.5), vec2(1.0, 1.0)];
    [
        ObstacleMotion::Static,
        ObstacleMotion::Orbit { centre_m: vec2(0.2, 0.1), speed_rad_s: (-0.3).into() },
        ObstacleMotion::Patrol { waypoints_m: waypoints_m.clone(), speed_m_s: 0.3.into() },
        ObstacleMotion::BackAndForth { waypoints_m: waypoints_m.clone(), speed_m_s: 0.3.into() },
        ObstacleMotion::RandomWalk { radius_m: 0.4, speed_m_s: 0.2.into(), seed: 3 },
        ObstacleMotion::Pedestrian {
            goals_m: waypoints_m.clone(),
            speed_m_s: 0.3.into(),
            loops: false,
            sees_robot: true,
        },
        ObstacleMotion::key_frames_along(vec2(0.5, 0.5), &waypoints_m, 0.3, true),
    ]
}

fn shapes() -> impl Iterator<Item = Shape> {
    Shape::templates().into_iter().map(|(_, shape)| shape)
}

fn obstacle(shape: Shape, motion: ObstacleMotion) -> Obstacle {
    Obstacle { shape, position_m: vec2(0.5, 0.5), rotation_rad: 0.0, motion }
}

/// The names before colons in RON text.
fn names_in(text: &str) -> BTreeSet<String> {
    let before_colons = text.split(':').map(|part| part.rsplit(|c: char| !(c.is_alphanumeric() || c == '_')));
    let mut names: Vec<_> = before_colons.filter_map(|mut words| words.next()).map(str::to_owned).collect();
    names.pop();
    names.into_iter().collect()
}

#[test]
fn every_field_of_the_file_format_is_described() {
    for mut shape in shapes() {
        let text = to_ron(&shape).expect("RON");
        let described =
            shape.fields_mut().iter().flat_map(|field| field.names).map(|name| (*name).into()).collect();
        assert_eq!(names_in(&text), described, "{text}");
    }
    for mut motion in motions() {
        let text = to_ron(&motion).expect("RON");
        let described =
            motion.fields_mut().iter().flat_map(|field| field.names).map(|name| (*name).into()).collect();
        assert_eq!(names_in(&text), described, "{text}");
    }
}

#[test]
fn every_kind_of_motion_can_be_chosen() {
    let kinds = motions().map(|motion| motion.kind());
    assert_eq!(kinds, MotionKind::ALL.map(|(kind, ..)| kind));
    assert!(MotionKind::ALL.iter().all(|(_, name, about)| !name.is_empty() && !about.is_empty()));
}

/// The numbers of an obstacle, each with its path in a scenario file and its largest value.
fn numbers(obstacle: &mut Obstacle) -> Vec<(String, &mut f32, f32)> {
    let shape = obstacle.shape.fields_mut().into_iter().map(|field| ("shape", field));
    let fields = shape.chain(obstacle.motion.fields_mut().into_iter().map(|field| ("motion", field)));
    let mut found = Vec::new();
    for (part, field) in fields {
        let path = |name: &str| format!("obstacles[0].{part}.{name}");
        match field.value {
            FieldValue::Number(number, quantity) | FieldValue::Ranged(Ranged::Number(number), quantity) => {
                found.push((path(field.names[0]), number, *quantity.range().end()));
            }
            FieldValue::Pair(pair, quantity) => found.extend(
                field
                    .names
                    .iter()
                    .zip(pair)
                    .map(|(name, number)| (path(name), number, *quantity.range().end())),
            ),
            _ => {}
        }
    }
    found
}

#[test]
fn every_number_above_its_range_is_reported_with_its_field() {
    let ball = || Shape::Circle { radius_m: 0.1 };
    let with_shapes = shapes().map(|shape| obstacle(shape, ObstacleMotion::Static));
    let with_motions = motions().map(|motion| obstacle(ball(), motion));
    let mut count = 0;
    for valid in with_shapes.chain(with_motions) {
        for k in 0..numbers(&mut valid.clone()).len() {
            let mut invalid = valid.clone();
            let (path, number, most) = numbers(&mut invalid).swap_remove(k);
            *number = most * 1.25;
            let found = diagnostics(&Scenario { obstacles: vec![invalid], ..Scenario::default() });
            assert!(found.iter().any(|problem| problem.path == path), "{path}: {found:?}");
            assert!(found[0].message.contains(&format!(" to {most}")), "{found:?}");
            count += 1;
        }
    }
    assert_eq!(count, 5 + 7 + 6, "the numbers of the shapes, of the seven balls and of their motions");
}

#[test]
fn an_obstacle_keeps_to_its_track_and_its_speed() {
    // The poses of pedestrians do not depend on the step alone; see tests/crowd.rs.
    for motion in motions().into_iter().filter(|motion| !motion.is_pedestrian()) {
        let o = obstacle(Shape::Circle { radius_m: 0.1 }, motion);
        let at = |step| {
            let (x, y, _) = pose_at(&o, step, PERIOD_S);
            vec2(x, y)
        };
        let off_track_m = |point: Vec2| match o.track() {
            Track::Point => point.distance(o.position_m),
            Track::Circle { centre_m } => (point.distance(centre_m) - o.position_m.distance(centre_m)).abs(),
            Track::Disc { radius_m } => point.distance(o.position_m) - radius_m,
            Track::Lines { mut corners_m, closed } => {
                corners_m.extend(closed.then_some(o.position_m));
                let legs =
                    corners_m.windows(2).map(|leg| polygon::distance_to_segment(leg[0], leg[1], point));
                legs.fold(f32::INFINITY, f32::min)
            }
        };
        let mut travelled_m = 0.0;
        for step in 0..200 {
            assert!(off_track_m(at(step)) < 1e-5, "{:?} at step {step}: {:?}", o.motion, at(step));
            let leg_m = at(step).distance(at(step + 1));
            assert!(leg_m <= o.origin_speed_m_s() * PERIOD_S + 1e-5, "{:?} at step {step}", o.motion);
            travelled_m += leg_m;
        }
        assert_eq!(travelled_m > 1.0, o.motion.is_moving(), "{:?}", o.motion);
        assert_eq!(o.motion.speed() == MotionSpeed::AtRest, o.motion == ObstacleMotion::Static);
    }
}

#[test]
fn a_motion_moves_with_its_obstacle() {
    let by = vec2(0.25, -0.5);
    for motion in motions() {
        let here = obstacle(Shape::Circle { radius_m: 0.1 }, motion);
        let mut there = here.clone();
        there.position_m += by;
        there.motion.translate(by);
        for step in [0, 7, 31] {
            let (a, b) = (pose_at(&here, step, PERIOD_S), pose_at(&there, step, PERIOD_S));
            assert!(
                vec2(b.0 - a.0, b.1 - a.1).distance(by) < 1e-5 && a.2 == b.2,
                "{:?} at {step}",
                here.motion
            );
        }
    }
}

#[test]
fn an_outline_lies_on_the_surface_of_its_shape() {
    for shape in shapes() {
        let corners: Vec<Vec2> = match shape.outline(8) {
            Outline::Circle(radius_m) => vec![vec2(0.0, radius_m as f32), vec2(-radius_m as f32, 0.0)],
            Outline::Polygon(corners) => corners.iter().map(|corner| corner.as_vec2()).collect(),
        };
        let inflated = shape.clone().inflated(0.1);
        for &corner in &corners {
            assert!(shape.distance(corner).abs() < 1e-6, "{shape:?}: {corner}");
            assert!(inflated.distance(corner) < -0.09, "{inflated:?}: {corner}");
        }
    }
}
