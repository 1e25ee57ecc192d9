//! Images of scenarios, seen from above.
//!
//! In: a scenario, or an arena of a simulation. Out: a map for the figures of reports, a standalone figure, or a frame of
//! the simulation.

use std::path::Path;

use bevy::math::{DVec2, Vec2, vec2};
use bevy::prelude::World;

use super::RunError;
use super::image_file::{self, ImageSize};
use crate::report::DrawError;
use crate::report::chart::{
    MapObstacle, MapObstacleKind, MapRobot, MapShape, MapTrack, MapTrajectory, ScenarioMap, contact_sheet_svg,
};
use crate::scenario::{IndexedScenario, Obstacle, ObstacleMotion, Outline, Scenario, Shape, Track};
use crate::task::{Arena, ArenaLayout, Clock, Goal, Pedestrians, Pose, Scan};

/// The layout seed of the generated obstacles in figures and thumbnails.
const LAYOUT_SEED: u64 = 1;
/// Number of straight segments in a capsule's round end.
const END_SEGMENTS: u32 = 16;

/// The map of `scenario` with the generated obstacles of `layout_seed`, at control step `clock`. It shows the
/// benchmark route, if there is one, and has no title or trajectories.
#[must_use]
pub fn map(scenario: &Scenario, layout_seed: u64, clock: u64) -> ScenarioMap {
    let generated = scenario.with_generated_obstacles(layout_seed);
    map_of(scenario, (&generated).into(), clock)
}

/// The map of `scenario` in its state `layout`, which has the generated obstacles and the pedestrians.
fn map_of(scenario: &Scenario, layout: IndexedScenario, clock: u64) -> ScenarioMap {
    let generated = layout.scenario;
    let pieces = generated.walls.iter().flat_map(wayfield_scenario::Wall::pieces);
    let walls = pieces.map(|piece| MapObstacle {
        kind: MapObstacleKind::Wall,
        outline: outline(&piece.shape, (piece.position_m.x, piece.position_m.y, piece.rotation_rad)),
    });
    let obstacles = generated.obstacles.iter().enumerate().map(|(index, obstacle)| {
        let kind = match heading(layout, index, clock) {
            Some(heading) => MapObstacleKind::Moving(heading),
            None if index < scenario.obstacles.len() => MapObstacleKind::Obstacle,
            None => MapObstacleKind::Generated,
        };
        MapObstacle { kind, outline: outline(&obstacle.shape, layout.pose_at(index, clock)) }
    });
    ScenarioMap {
        title: String::new(),
        enclosure: scenario.enclosure.corners_m().into_iter().map(wide).collect(),
        marked_areas: Vec::new(),
        obstacles: walls.chain(obstacles).collect(),
        tracks: scenario.obstacles.iter().filter_map(track).collect(),
        start: scenario.benchmark_route.map(|route| {
            let (x, y) = wide(route.start_m);
            (x, y, f64::from(route.heading_rad))
        }),
        goal: scenario.benchmark_route.map(|route| {
            let (x, y) = wide(route.goal_m);
            (x, y, f64::from(scenario.task.goal_radius_m))
        }),
        trajectories: Vec::new(),
    }
}

/// The figure of `scenario` at control step 0, as SVG: with its name, a legend, and axes in m.
///
/// # Errors
/// The drawing library failed. No input is known to cause this.
pub fn figure(scenario: &Scenario) -> Result<String, DrawError> {
    figure_over(scenario, Vec::new())
}

/// Like [`figure`], with marked areas, such as the occupied cells of an imported map. Each is given by its corners in m.
///
/// # Errors
/// The drawing library failed. No input is known to cause this.
pub fn figure_over(scenario: &Scenario, marked_areas: Vec<Vec<(f64, f64)>>) -> Result<String, DrawError> {
    let title = scenario.name.clone();
    ScenarioMap { title, marked_areas, ..map(scenario, LAYOUT_SEED, 0) }.svg()
}

/// The thumbnail of `scenario` at control step 0, 480 x 360 pixels, as SVG: without name, legend and axes.
///
/// # Errors
/// The drawing library failed. No input is known to cause this.
pub fn thumbnail(scenario: &Scenario) -> Result<String, DrawError> {
    map(scenario, LAYOUT_SEED, 0).thumbnail_svg()
}

/// The figure of `levels` at control step 0, side by side under their names, as SVG.
///
/// # Errors
/// The drawing library failed. No input is known to cause this.
pub fn contact_sheet(title: &str, levels: &[Scenario]) -> Result<String, DrawError> {
    let map = |level: &Scenario| ScenarioMap { title: level.name.clone(), ..map(level, LAYOUT_SEED, 0) };
    contact_sheet_svg(title, &levels.iter().map(map).collect::<Vec<_>>())
}

/// Writes the thumbnail of `scenario` to `path`, in the format that its extension names.
///
/// # Errors
/// The extension names no format, drawing fails, or the file cannot be written.
pub fn draw(scenario: &Scenario, path: &Path) -> Result<(), RunError> {
    let svg = thumbnail(scenario).map_err(|error| RunError::failed(path, error))?;
    image_file::write(svg, ImageSize::Screen, path)
}

/// The current state of `arena` in the simulation `world`, as the text of an SVG file of 480 x 360 pixels: enclosure,
/// obstacles and goal, the robot to scale with its heading, and the beams of the reported scan. `None` if there is no such
/// arena.
///
/// # Errors
/// Drawing fails.
pub fn frame_svg(world: &mut World, arena: usize) -> Option<Result<String, DrawError>> {
    frame_with_path(world, arena, Vec::new())
}

/// Like [`frame_svg`], with the robot's path so far: its positions in m.
///
/// # Errors
/// Drawing fails.
pub fn frame_with_path(
    world: &mut World,
    arena: usize,
    path_m: Vec<(f64, f64)>,
) -> Option<Result<String, DrawError>> {
    let mut arenas = world.query::<(&Arena, (&ArenaLayout, &Pedestrians), &Clock, &Pose, &Goal, &Scan)>();
    let (_, (layout, pedestrians), clock, pose, goal, scan) =
        arenas.iter(world).find(|(found, ..)| found.0 == arena)?;
    let scenario = &*layout.written;
    let goal = wide(vec2(goal.x_m, goal.y_m));
    let goal = (goal.0, goal.1, f64::from(scenario.task.goal_radius_m));
    let trajectories = vec![MapTrajectory { points: path_m, ..MapTrajectory::default() }];
    let map = map_of(scenario, layout.indexed(pedestrians), clock.0);
    let map = ScenarioMap { goal: Some(goal), tracks: Vec::new(), trajectories, ..map };
    Some(map.frame_svg(&robot(&layout.scenario, pose, scan)))
}

/// The robot of `scenario` at `pose`, with the beams of `scan`.
fn robot(scenario: &Scenario, pose: &Pose, scan: &Scan) -> MapRobot {
    let (x, y) = wide(vec2(pose.x_m, pose.y_m));
    let sensor = &scan.sensor_pose;
    let (lidar_x, lidar_y) = wide(vec2(sensor.x_m, sensor.y_m));
    let beam_ends = scan.ranges_m.iter().enumerate().map(|(beam, range_m)| {
        let (sin, cos) = (f64::from(sensor.heading_rad) + scenario.lidar.beam_angle_rad(beam)).sin_cos();
        (lidar_x + f64::from(*range_m) * cos, lidar_y + f64::from(*range_m) * sin)
    });
    MapRobot {
        pose: (x, y, f64::from(pose.heading_rad)),
        nose: f64::from(scenario.robot.inner_radius_m()),
        body: outline(&scenario.robot.body(), (pose.x_m, pose.y_m, pose.heading_rad)),
        lidar: (lidar_x, lidar_y),
        beam_ends: beam_ends.collect(),
    }
}

/// An obstacle's direction of motion in rad from the x axis; `None` if it stands still.
fn heading(layout: IndexedScenario, obstacle: usize, clock: u64) -> Option<f64> {
    let start = &layout.scenario.obstacles[obstacle];
    let (dx, dy) = match (layout.pedestrian(obstacle), &start.motion) {
        (Some(pedestrian), _) => wide(pedestrian.velocity_m_s),
        // At the start of an episode: towards its first goal.
        (None, ObstacleMotion::Pedestrian { goals_m, .. }) => wide(*goals_m.first()? - start.position_m),
        (None, _) => {
            let (now, next) = (layout.pose_at(obstacle, clock), layout.pose_at(obstacle, clock + 1));
            (f64::from(next.0) - f64::from(now.0), f64::from(next.1) - f64::from(now.1))
        }
    };
    (dx != 0.0 || dy != 0.0).then(|| dy.atan2(dx))
}

/// The area that a shape covers at a pose (x in m, y in m, rotation in rad).
fn outline(shape: &Shape, (x, y, rotation): (f32, f32, f32)) -> MapShape {
    let (x, y) = wide(vec2(x, y));
    let (sin, cos) = f64::from(rotation).sin_cos();
    let to_map = |at: DVec2| (x + cos * at.x - sin * at.y, y + sin * at.x + cos * at.y);
    match shape.outline(END_SEGMENTS) {
        Outline::Circle(radius) => MapShape::Disc(x, y, radius),
        Outline::Polygon(corners) => MapShape::Polygon(corners.into_iter().map(to_map).collect()),
    }
}

/// The path of an obstacle; `None` if it stands still.
fn track(obstacle: &Obstacle) -> Option<MapTrack> {
    let (x, y) = wide(obstacle.position_m);
    match obstacle.track() {
        Track::Point => None,
        Track::Circle { centre_m } => {
            let (centre_x, centre_y) = wide(centre_m);
            Some(MapTrack::Ring(centre_x, centre_y, (x - centre_x).hypot(y - centre_y)))
        }
        Track::Lines { corners_m, closed } => {
            Some(MapTrack::Lines(corners_m.into_iter().map(wide).chain(closed.then_some((x, y))).collect()))
        }
        Track::Disc { radius_m } => Some(MapTrack::Ring(x, y, f64::from(radius_m))),
    }
}

fn wide(Vec2 { x, y }: Vec2) -> (f64, f64) {
    (f64::from(x), f64::from(y))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

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
    fn the_map_shows_every_obstacle_at_its_current_pose() {
        let corners_m = vec![vec2(-3.0, -2.0), vec2(3.0, -2.0), vec2(0.0, 2.0)];
        let rectangle = Shape::Rectangle { width_m: 0.4, height_m: 0.2 };
        let waypoints_m = vec![vec2(1.0, 1.0), vec2(0.0, 1.0)];
        let capsule = Shape::Capsule { length_m: 1.0, radius_m: 0.25 };
        let scenario = Scenario {
            enclosure: Enclosure::Polygon { corners_m },
            walls: vec![Wall {
                corners_m: vec![vec2(0.0, 0.0), vec2(0.0, 1.0)],
                thickness_m: 0.2,
                ..Wall::default()
            }],
            obstacles: vec![
                obstacle(rectangle, ObstacleMotion::Static),
                obstacle(capsule, ObstacleMotion::Patrol { waypoints_m, speed_m_s: 0.5.into() }),
            ],
            generators: vec![Generator {
                count: 1,
                shape: RandomShape::Circle { radius_m: (0.1, 0.1) },
                gap_m: 0.3,
                within: None,
            }],
            ..Scenario::default()
        };
        // At 0.5 m/s and 0.2 s per step, the capsule is 1.5 m along its loop after 15 steps, 0.5 m past the corner.
        let map = map(&scenario, LAYOUT_SEED, 15);
        assert_near(&map.enclosure, &[(-3.0, -2.0), (3.0, -2.0), (0.0, 2.0)]);
        let kinds: Vec<MapObstacleKind> = map.obstacles.iter().map(|obstacle| obstacle.kind).collect();
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
        // The wall segment is vertical and 1.2 m long with its ends; the rectangle is rotated by 90 degrees.
        assert_near(&corners(0), &[(-0.1, 1.1), (-0.1, -0.1), (0.1, -0.1), (0.1, 1.1)]);
        assert_near(&corners(1), &[(0.9, 0.2), (0.9, -0.2), (1.1, -0.2), (1.1, 0.2)]);
        let capsule = corners(2);
        let extent = |of: fn(&(f64, f64)) -> f64| {
            let (low, high) =
                capsule.iter().map(of).fold((9.0_f64, -9.0_f64), |(l, h), v| (l.min(v), h.max(v)));
            [(low, high)]
        };
        assert_near(&extent(|at| at.0), &[(0.25, 0.75)]);
        assert_near(&extent(|at| at.1), &[(0.25, 1.75)]);
        let MapObstacleKind::Moving(heading) = kinds[2] else { panic!("the obstacle moves") };
        assert!((heading.abs() - PI).abs() < 1e-3, "it moves to the left, not to {heading}");
        let [MapTrack::Lines(loop_m)] = &map.tracks[..] else { panic!("one obstacle moves") };
        assert_near(loop_m, &[(1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (1.0, 0.0)]);
        assert_eq!((map.start, map.goal), (None, None), "it has no benchmark route");
    }

    #[test]
    fn orbits_and_random_walks_are_shown_as_rings() {
        let disc = || Shape::Circle { radius_m: 0.1 };
        let orbit = ObstacleMotion::Orbit { centre_m: vec2(1.0, 2.0), speed_rad_s: 0.1.into() };
        assert_eq!(track(&obstacle(disc(), orbit)), Some(MapTrack::Ring(1.0, 2.0, 2.0)));
        let walk = ObstacleMotion::RandomWalk { radius_m: 0.5, speed_m_s: 0.1.into(), seed: 0 };
        assert_eq!(track(&obstacle(disc(), walk)), Some(MapTrack::Ring(1.0, 0.0, 0.5)));
        assert_eq!(track(&obstacle(disc(), ObstacleMotion::Static)), None);
    }
}
