//! The data of a scenario map, in metres and radians; the x axis points right, the y axis up.

/// A scenario seen from above, with trajectories through it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScenarioMap {
    /// The title above the figure.
    pub title: String,
    /// The corners of the enclosing walls, counterclockwise, in m.
    pub enclosure: Vec<(f64, f64)>,
    /// Areas that are marked over the obstacles: the occupied cells of an occupancy grid map. The corners of each, in m.
    pub marked_areas: Vec<Vec<(f64, f64)>>,
    /// Walls and obstacles; later ones are drawn over earlier ones.
    pub obstacles: Vec<MapObstacle>,
    /// The tracks of moving obstacles.
    pub tracks: Vec<MapTrack>,
    /// The robot's start: x and y in m, heading in rad, counterclockwise from the x axis.
    pub start: Option<(f64, f64, f64)>,
    /// The goal: x, y and radius, in m.
    pub goal: Option<(f64, f64, f64)>,
    /// The robot's trajectories.
    pub trajectories: Vec<MapTrajectory>,
}

/// A wall or an obstacle.
#[derive(Clone, Debug, PartialEq)]
pub struct MapObstacle {
    /// The kind, which determines the colour.
    pub kind: MapObstacleKind,
    /// The outline.
    pub outline: MapShape,
}

/// The kind of a wall or an obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MapObstacleKind {
    /// A segment of an inner wall.
    Wall,
    /// A static obstacle.
    Obstacle,
    /// A static obstacle that is generated for each episode.
    Generated,
    /// A moving obstacle, with its direction in rad, counterclockwise from the x axis.
    Moving(f64),
}

/// The outline of a wall or an obstacle.
#[derive(Clone, Debug, PartialEq)]
pub enum MapShape {
    /// A disc: centre x, y and radius, in m.
    Disc(f64, f64, f64),
    /// A polygon: its corners in order, in m.
    Polygon(Vec<(f64, f64)>),
}

/// The path of a moving obstacle, or the area it stays in.
#[derive(Clone, Debug, PartialEq)]
pub enum MapTrack {
    /// Straight segments between points, in m.
    Lines(Vec<(f64, f64)>),
    /// A circular orbit, or the disc that a random walk stays in: centre x, y and radius, in m.
    Ring(f64, f64, f64),
}

/// A robot in a frame of a simulation.
#[derive(Clone, Debug, PartialEq)]
pub struct MapRobot {
    /// The pose: x and y in m, heading in rad, counterclockwise from the x axis.
    pub pose: (f64, f64, f64),
    /// The area that its body covers.
    pub body: MapShape,
    /// The length of the line that shows its heading, in m.
    pub nose: f64,
    /// The position of the LIDAR during the scan: x and y in m.
    pub lidar: (f64, f64),
    /// The end of each beam: x and y in m.
    pub beam_ends: Vec<(f64, f64)>,
}

/// A robot's trajectory through the scenario.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MapTrajectory {
    /// The short name in the legend.
    pub name: String,
    /// The colour's index in the palette, modulo the palette's length.
    pub colour: usize,
    /// The positions x and y in m, in chronological order.
    pub points: Vec<(f64, f64)>,
}
