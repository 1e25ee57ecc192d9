//! A world from above, as a picture.
//!
//! In: a scenario. Out: the plan that figures of it start from, and a small picture of it as an SVG or PNG file.

use std::f64::consts::{FRAC_PI_2, PI};
use std::io::Write;
use std::path::Path;

use bevy::math::{Vec2, vec2};

use super::RunError;
use super::folder::write_atomic;
use crate::report::chart::{MapObstacle, MapObstacleKind, MapShape, MapTrack, ScenarioMap};
use crate::report::{DrawError, raster};
use crate::scenario::{Obstacle, ObstacleMotion, Scenario, Shape, pose_at};

/// Which layout of the generated obstacles a picture shows.
const LAYOUT: u64 = 1;
/// Straight pieces of a rod's round end.
const END_PIECES: u32 = 16;

/// The world with layout number `layout_seed` ([`Scenario::with_generated_obstacles`]) at the step `clock`, with its benchmark route and without a title
/// or paths.
#[must_use]
pub fn map(scenario: &Scenario, layout_seed: u64, clock: u64) -> ScenarioMap {
    let generated = scenario.with_generated_obstacles(layout_seed);
    let pieces = generated.walls.iter().flat_map(|wall| wall.segments());
    let walls = pieces
        .map(|piece| MapObstacle { kind: MapObstacleKind::Wall, outline: outline(&piece, &generated, 0) });
    let obstacles = generated.obstacles.iter().enumerate().map(|(index, obstacle)| {
        let kind = match heading(obstacle, &generated, clock) {
            Some(heading) => MapObstacleKind::Moving(heading),
            None if index < scenario.obstacles.len() => MapObstacleKind::Obstacle,
            None => MapObstacleKind::Generated,
        };
        MapObstacle { kind, outline: outline(obstacle, &generated, clock) }
    });
    let course = &scenario.benchmark_route;
    let ((start_x, start_y), (target_x, target_y)) = (wide(course.start_m), wide(course.goal_m));
    ScenarioMap {
        title: String::new(),
        enclosure: scenario.enclosure.corners_m().into_iter().map(wide).collect(),
        obstacles: walls.chain(obstacles).collect(),
        tracks: scenario.obstacles.iter().filter_map(track).collect(),
        start: (start_x, start_y, f64::from(course.heading_rad)),
        goal: (target_x, target_y, f64::from(scenario.task.goal_radius_m)),
        trajectories: Vec::new(),
    }
}

/// Writes a picture of the world at step 0 to the file `path`, as SVG or PNG by the ending of its name; 480 x 360
/// pixels.
///
/// # Errors
/// Another ending; the drawing failed; the file cannot be written.
pub fn draw(scenario: &Scenario, path: &Path) -> Result<(), RunError> {
    let ending = path.extension().map(|ending| ending.to_ascii_lowercase());
    let failed = |error: DrawError| RunError::failed(path, error);
    let svg = || map(scenario, LAYOUT, 0).thumbnail_svg().map_err(failed);
    let bytes = match ending.as_ref().and_then(|ending| ending.to_str()) {
        Some("svg") => svg()?.into_bytes(),
        Some("png") => raster::png(&svg()?, 1.0).map_err(failed)?,
        _ => return Err(RunError::invalid_input(path, "write a name that ends in .svg or .png")),
    };
    write_atomic(path, |file| file.write_all(&bytes))
        .map_err(|error| RunError::failed(path, format!("can't be written: {error}")))
}

/// Where an obstacle goes next, in rad from the x axis; none if it stands still.
fn heading(obstacle: &Obstacle, scenario: &Scenario, clock: u64) -> Option<f64> {
    let at = |step| pose_at(obstacle, step, scenario.task.control_period_s);
    let (now, next) = (at(clock), at(clock + 1));
    let (dx, dy) = (f64::from(next.0) - f64::from(now.0), f64::from(next.1) - f64::from(now.1));
    (dx != 0.0 || dy != 0.0).then(|| dy.atan2(dx))
}

/// What an obstacle covers at the step `clock`.
fn outline(obstacle: &Obstacle, scenario: &Scenario, clock: u64) -> MapShape {
    let (x, y, turn) = pose_at(obstacle, clock, scenario.task.control_period_s);
    let (x, y) = wide(vec2(x, y));
    let (sin, cos) = f64::from(turn).sin_cos();
    let place = |(dx, dy): (f64, f64)| (x + cos * dx - sin * dy, y + sin * dx + cos * dy);
    let own: Vec<(f64, f64)> = match &obstacle.shape {
        Shape::Circle { radius_m } => return MapShape::Disc(x, y, f64::from(*radius_m)),
        Shape::Rectangle { width_m, height_m } => {
            let (w, h) = (f64::from(*width_m) / 2.0, f64::from(*height_m) / 2.0);
            vec![(w, h), (-w, h), (-w, -h), (w, -h)]
        }
        Shape::Polygon { corners_m } => corners_m.iter().copied().map(wide).collect(),
        Shape::Capsule { length_m, radius_m } => {
            let (half, radius) = (f64::from(*length_m) / 2.0, f64::from(*radius_m));
            let end = |middle: f64, from: f64| {
                (0..=END_PIECES).map(move |i| {
                    let (sin, cos) = (from + PI * f64::from(i) / f64::from(END_PIECES)).sin_cos();
                    (middle + radius * cos, radius * sin)
                })
            };
            end(half, -FRAC_PI_2).chain(end(-half, FRAC_PI_2)).collect()
        }
    };
    MapShape::Polygon(own.into_iter().map(place).collect())
}

/// Where an obstacle goes; none if it stands still.
fn track(obstacle: &Obstacle) -> Option<MapTrack> {
    let (x, y) = wide(obstacle.position_m);
    match &obstacle.motion {
        ObstacleMotion::Static => None,
        ObstacleMotion::Orbit { centre_m, .. } => {
            let (centre_x, centre_y) = wide(*centre_m);
            Some(MapTrack::Ring(centre_x, centre_y, (x - centre_x).hypot(y - centre_y)))
        }
        ObstacleMotion::Patrol { .. } | ObstacleMotion::BackAndForth { .. } => {
            let (path, closed) = obstacle.path_m()?;
            Some(MapTrack::Lines(path.into_iter().map(wide).chain(closed.then_some((x, y))).collect()))
        }
        ObstacleMotion::RandomWalk { radius_m, .. } => Some(MapTrack::Ring(x, y, f64::from(*radius_m))),
    }
}

fn wide(Vec2 { x, y }: Vec2) -> (f64, f64) {
    (f64::from(x), f64::from(y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::{Enclosure, Generator, RandomShape, Wall};

    fn obstacle(shape: Shape, motion: ObstacleMotion) -> Obstacle {
        Obstacle { shape, position_m: vec2(1.0, 0.0), rotation_rad: std::f32::consts::FRAC_PI_2, motion }
    }

    fn assert_near(found: &[(f64, f64)], expected: &[(f64, f64)]) {
        let near = |a: &(f64, f64), b: &(f64, f64)| (a.0 - b.0).abs() < 1e-6 && (a.1 - b.1).abs() < 1e-6;
        let all = found.len() == expected.len() && found.iter().zip(expected).all(|(a, b)| near(a, b));
        assert!(all, "{found:?} is not {expected:?}");
    }

    #[test]
    fn the_plan_shows_what_stands_and_moves_where_it_is() {
        let corners_m = vec![vec2(-3.0, -2.0), vec2(3.0, -2.0), vec2(0.0, 2.0)];
        let rectangle = Shape::Rectangle { width_m: 0.4, height_m: 0.2 };
        let waypoints_m = vec![vec2(1.0, 1.0), vec2(0.0, 1.0)];
        let rod = Shape::Capsule { length_m: 1.0, radius_m: 0.25 };
        let scenario = Scenario {
            enclosure: Enclosure::Polygon { corners_m },
            walls: vec![Wall { corners_m: vec![vec2(0.0, 0.0), vec2(0.0, 1.0)], thickness_m: 0.2 }],
            obstacles: vec![
                obstacle(rectangle, ObstacleMotion::Static),
                obstacle(rod, ObstacleMotion::Patrol { waypoints_m, speed_m_s: 0.5 }),
            ],
            generators: vec![Generator {
                count: 1,
                shape: RandomShape::Circle { radius_m: (0.1, 0.1) },
                gap_m: 0.3,
                within: None,
            }],
            ..Scenario::default()
        };
        // Half a metre a second, 0.2 s a step: after 15 steps 1.5 m on its loop, half a metre past the corner.
        let map = map(&scenario, LAYOUT, 15);
        assert_near(&map.enclosure, &[(-3.0, -2.0), (3.0, -2.0), (0.0, 2.0)]);
        let kinds: Vec<MapObstacleKind> = map.obstacles.iter().map(|solid| solid.kind).collect();
        assert!(
            matches!(
                kinds[..],
                [
                    MapObstacleKind::Wall,
                    MapObstacleKind::Obstacle,
                    MapObstacleKind::Moving(_),
                    MapObstacleKind::Generated
                ]
            ),
            "{kinds:?}"
        );
        let corners = |index: usize| match &map.obstacles[index].outline {
            MapShape::Polygon(corners) => corners.clone(),
            MapShape::Disc(..) => panic!("a circle"),
        };
        // The wall's piece is upright and 1.2 m long, the box is turned by a quarter.
        assert_near(&corners(0), &[(-0.1, 1.1), (-0.1, -0.1), (0.1, -0.1), (0.1, 1.1)]);
        assert_near(&corners(1), &[(0.9, 0.2), (0.9, -0.2), (1.1, -0.2), (1.1, 0.2)]);
        let rod = corners(2);
        let extent = |of: fn(&(f64, f64)) -> f64| {
            let (low, high) = rod.iter().map(of).fold((9.0_f64, -9.0_f64), |(l, h), v| (l.min(v), h.max(v)));
            [(low, high)]
        };
        assert_near(&extent(|at| at.0), &[(0.25, 0.75)]);
        assert_near(&extent(|at| at.1), &[(0.25, 1.75)]);
        let MapObstacleKind::Moving(heading) = kinds[2] else { panic!("it moves") };
        assert!((heading.abs() - PI).abs() < 1e-3, "it goes to the left, not to {heading}");
        let [MapTrack::Lines(loop_m)] = &map.tracks[..] else { panic!("one moves") };
        assert_near(loop_m, &[(1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (1.0, 0.0)]);
        assert_eq!((map.start, map.goal.2), ((0.0, 0.0, 0.0), f64::from(0.2_f32)));
    }

    #[test]
    fn rings_show_an_orbit_and_the_reach_of_a_random_walk() {
        let disc = || Shape::Circle { radius_m: 0.1 };
        let orbit = ObstacleMotion::Orbit { centre_m: vec2(1.0, 2.0), speed_rad_s: 0.1 };
        assert_eq!(track(&obstacle(disc(), orbit)), Some(MapTrack::Ring(1.0, 2.0, 2.0)));
        let walk = ObstacleMotion::RandomWalk { radius_m: 0.5, speed_m_s: 0.1, seed: 0 };
        assert_eq!(track(&obstacle(disc(), walk)), Some(MapTrack::Ring(1.0, 0.0, 0.5)));
        assert_eq!(track(&obstacle(disc(), ObstacleMotion::Static)), None);
    }

    #[test]
    fn a_picture_is_an_svg_or_a_png_by_its_name() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = |name: &str| folder.path().join(name);
        for (name, first) in [("a.svg", &b"<svg"[..]), ("b.PNG", b"\x89PNG")] {
            draw(&Scenario::default(), &file(name)).expect("is drawn");
            let bytes = std::fs::read(file(name)).expect("is there");
            assert!(bytes.starts_with(first), "{name}");
        }
        let error = draw(&Scenario::default(), &file("c.gif")).expect_err("no such picture");
        assert_eq!(error.exit_status(), 2);
        assert!(error.to_string().ends_with("c.gif: write a name that ends in .svg or .png"), "{error}");
        assert!(!file("c.gif").exists());
        let nowhere = draw(&Scenario::default(), &file("no/d.svg")).expect_err("there is no such folder");
        assert!(nowhere.to_string().contains("can't be written"), "{nowhere}");
    }
}
