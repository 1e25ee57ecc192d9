//! The kinds of motion and the fields of motions.

use super::fields::{Field, FieldValue, Quantity};
use super::schema::ObstacleMotion;
use glam::Vec2;

/// The kind of a motion, without its parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotionKind {
    /// No motion.
    Static,
    /// Around a point.
    Orbit,
    /// Along a closed path.
    Patrol,
    /// Along a path and back.
    BackAndForth,
    /// Between random points.
    RandomWalk,
    /// To goals, avoiding other pedestrians, walls and static obstacles.
    Pedestrian,
    /// Along recorded positions.
    KeyFrames,
}

impl MotionKind {
    /// All kinds, each with its name and a description for the screen.
    pub const ALL: [(Self, &'static str, &'static str); 7] = [
        (Self::Static, "Static", "Does not move"),
        (Self::Orbit, "Orbit", "Around a point, as if fixed to a turntable"),
        (Self::Patrol, "Patrol", "Along a closed path"),
        (Self::BackAndForth, "Back and forth", "Along a path and back"),
        (Self::RandomWalk, "Random walk", "Between random points near its position"),
        (Self::Pedestrian, "Pedestrian", "To its goals, avoiding other pedestrians"),
        (Self::KeyFrames, "Key frames", "Through recorded positions at recorded times"),
    ];
}

impl ObstacleMotion {
    /// The kind.
    #[must_use]
    pub fn kind(&self) -> MotionKind {
        match self {
            Self::Static => MotionKind::Static,
            Self::Orbit { .. } => MotionKind::Orbit,
            Self::Patrol { .. } => MotionKind::Patrol,
            Self::BackAndForth { .. } => MotionKind::BackAndForth,
            Self::RandomWalk { .. } => MotionKind::RandomWalk,
            Self::Pedestrian { .. } => MotionKind::Pedestrian,
            Self::KeyFrames { .. } => MotionKind::KeyFrames,
        }
    }

    /// Whether this is the motion of a pedestrian, whose pose depends on more than the step ([`Crowd`](super::Crowd)).
    #[must_use]
    pub fn is_pedestrian(&self) -> bool {
        matches!(self, Self::Pedestrian { .. })
    }

    /// The fields, in the order in which they are shown.
    #[must_use]
    pub fn fields_mut(&mut self) -> Vec<Field<'_>> {
        use FieldValue::{Centre, Flag, KeyFrames, Number, Ranged, Seed, Waypoints};
        let field = |names, label, about, value| Field { names, label, about, value };
        match self {
            Self::Static => Vec::new(),
            Self::Orbit { centre_m, speed_rad_s } => {
                let speed = Ranged(speed_rad_s, Quantity::AngularSpeed);
                vec![
                    field(&["centre_m"], "Centre", "Centre of the orbit", Centre(centre_m)),
                    field(&["speed_rad_s"], "Speed", "Counterclockwise", speed),
                ]
            }
            Self::Patrol { waypoints_m, speed_m_s } | Self::BackAndForth { waypoints_m, speed_m_s } => {
                let speed = Ranged(speed_m_s, Quantity::Speed);
                vec![
                    field(&["speed_m_s"], "Speed", "Along the path", speed),
                    field(&["waypoints_m"], "Point", "", Waypoints(waypoints_m)),
                ]
            }
            Self::RandomWalk { radius_m, speed_m_s, seed } => {
                let reach = Number(radius_m, Quantity::Reach);
                let speed = Ranged(speed_m_s, Quantity::Speed);
                vec![
                    field(&["radius_m"], "Walk radius", "Largest distance from its position", reach),
                    field(&["speed_m_s"], "Speed", "Highest speed", speed),
                    field(&["seed"], "Seed", "Obstacles with the same seed walk alike", Seed(seed)),
                ]
            }
            Self::Pedestrian { goals_m, speed_m_s, loops, sees_robot } => {
                let speed = Ranged(speed_m_s, Quantity::Speed);
                let (repeat, sees) = ("Return to the position and start again", "Avoid the robot, too");
                vec![
                    field(&["speed_m_s"], "Speed", "Highest speed", speed),
                    field(&["loops"], "Repeat", repeat, Flag(loops)),
                    field(&["sees_robot"], "Sees the robot", sees, Flag(sees_robot)),
                    field(&["goals_m"], "Goal", "", Waypoints(goals_m)),
                ]
            }
            Self::KeyFrames { frames, end } => {
                let names = &["frames", "time_s", "position_m", "end", "period_s"];
                vec![field(names, "Frame", "", KeyFrames(frames, end))]
            }
        }
    }

    /// The number that measures `quantity`, if the motion has one.
    #[must_use]
    pub fn number_mut(&mut self, quantity: Quantity) -> Option<&mut f32> {
        self.fields_mut().into_iter().find_map(|field| match field.value {
            FieldValue::Number(number, of) if of == quantity => Some(number),
            _ => None,
        })
    }

    /// The centre of the orbit, in m, if the motion is an orbit.
    #[must_use]
    pub fn centre_mut(&mut self) -> Option<&mut Vec2> {
        self.fields_mut().into_iter().find_map(|field| match field.value {
            FieldValue::Centre(centre_m) => Some(centre_m),
            _ => None,
        })
    }

    /// The points that move with the obstacle when it is edited, in m: the centre of an orbit, the waypoints of a path, the
    /// goals of a pedestrian or the positions of key frames.
    #[must_use]
    pub fn points_mut(&mut self) -> Vec<&mut Vec2> {
        let mut points = Vec::new();
        for field in self.fields_mut() {
            match field.value {
                FieldValue::Centre(centre_m) => points.push(centre_m),
                FieldValue::Waypoints(waypoints_m) => points.extend(waypoints_m),
                FieldValue::KeyFrames(frames, _) => {
                    points.extend(frames.iter_mut().map(|frame| &mut frame.position_m));
                }
                _ => {}
            }
        }
        points
    }

    /// Shifts all points of the motion by `offset`.
    pub fn translate(&mut self, offset: Vec2) {
        self.points_mut().into_iter().for_each(|point| *point += offset);
    }
}
