//! The parameters of the drivers, as RON.

use std::path::Path;

use serde::{Deserialize, Serialize};
use wayfield_policy::range::{within, within_above_zero};
use wayfield_scenario::{Diagnostic, FileError, parse_checked, resemblance};

use crate::Driver;
use crate::dwa::{DwaDriver, TrackingDwaDriver};
use crate::field::Field;
use crate::orca::OrcaDriver;
use crate::planned::{Planned, Steering};
use crate::robot::Robot;
use crate::rolling_map::RollingMap;
use crate::true_map::TrueMap;

/// What a driver may perceive. Results of different classes do not belong in one column.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub enum DriverClass {
    /// The scans, the goal and the robot's own motion of the last second, like a policy.
    A,
    /// The same as class A, and a map that it builds as it drives.
    B,
    /// The true scenario and pose.
    C,
}

impl DriverClass {
    /// What a driver of this class may perceive, in a few words.
    #[must_use]
    pub fn about(self) -> &'static str {
        match self {
            Self::A => "Class A: sees what a policy sees",
            Self::B => "Class B: builds a map",
            Self::C => "Class C: knows everything",
        }
    }
}

/// A classical driver with its parameters. Lengths that are not in m are in units of the keep-out distance: the reach of the
/// robot's body or the collision range, whichever is larger.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum DriverConfig {
    /// Potential field, class A.
    Field(FieldParameters),
    /// Dynamic window approach, which treats everything in the scan as static; class A.
    Dwa(DwaParameters),
    /// Dynamic window approach with constant velocities of moving obstacles, which it estimates from the scans; class A.
    DwaCv(TrackingParameters),
    /// A* on a map that is built from the scans, and the dynamic window approach towards a point of the path; class B.
    GridDwa(PlannerParameters),
    /// A* on the true map, and the dynamic window approach towards a point of the path; class C.
    AstarDwa(PlannerParameters),
    /// A* on the true map and pure pursuit of the path; class C.
    Astar(AstarParameters),
    /// Optimal reciprocal collision avoidance with the true poses and velocities; class C.
    Orca(OrcaParameters),
}

/// The potential field.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct FieldParameters {
    /// Strength of the repulsion relative to the attraction of the goal, 0 to 1,000.
    pub repulsion: f32,
    /// Distance from the keep-out circle at which surfaces begin to repel, 0.1 to 100 keep-out distances.
    pub influence_distance: f32,
    /// Distance from the keep-out circle below which the robot slows down, above 0, at most 100 keep-out distances.
    pub slow_distance: f32,
    /// Time to turn to the direction of the force, 0.001 to 100 s.
    pub turn_time_s: f32,
}

impl Default for FieldParameters {
    fn default() -> Self {
        Self { repulsion: 0.5, influence_distance: 4.0, slow_distance: 2.0, turn_time_s: 0.4 }
    }
}

/// The dynamic window approach. The score of a motion is the weighted sum of three terms, each between 0 and 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DwaParameters {
    /// Simulated time ahead, 0.1 to 60 s.
    pub horizon_s: f32,
    /// The heading towards the goal is measured after this time, 0.001 to 60 s.
    pub heading_time_s: f32,
    /// Weight of the heading towards the goal, 0 to 1,000.
    pub heading: f32,
    /// Weight of the time until a collision, 0 to 1,000.
    pub clearance: f32,
    /// Weight of the speed, 0 to 1,000.
    pub speed: f32,
    /// Distance to keep beyond the keep-out distance, 0 to 10 keep-out distances. A robot that is already within it must not
    /// come any closer.
    pub margin: f32,
    /// Points of earlier scans are remembered for this time, moved by odometry, 0 to 1 s.
    pub memory_s: f32,
}

impl Default for DwaParameters {
    fn default() -> Self {
        Self {
            horizon_s: 2.0,
            heading_time_s: 0.6,
            heading: 0.2,
            clearance: 0.2,
            speed: 1.0,
            margin: 0.2,
            memory_s: 0.6,
        }
    }
}

/// The dynamic window approach with estimated velocities.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct TrackingParameters {
    /// The dynamic window approach. It remembers only points that do not move.
    pub dwa: DwaParameters,
    /// Largest extent of an obstacle that may move, 0.1 to 100 keep-out distances. Larger things are taken for walls.
    pub max_extent: f32,
    /// Neighbouring hits belong to one cluster if their distance is at most this many times the distance between beams at that
    /// range, 1 to 100.
    pub link: f32,
    /// Gain of the filter for positions, above 0, at most 1.
    pub position_gain: f32,
    /// Gain of the filter for velocities, above 0, at most 1.
    pub velocity_gain: f32,
    /// Scans in which a thing must have been seen before its velocity counts, 2 to 100.
    pub min_scans: u32,
    /// Lowest speed that counts as motion, 0 to 5 m/s.
    pub min_speed_m_s: f32,
    /// A thing counts as moving only if, in a scan of the last second, the beams towards its present position ended at least
    /// this far behind it, 0 to 100 keep-out distances.
    pub free_margin: f32,
}

impl Default for TrackingParameters {
    fn default() -> Self {
        Self {
            dwa: DwaParameters::default(),
            max_extent: 5.0,
            link: 2.0,
            position_gain: 0.6,
            velocity_gain: 0.3,
            min_scans: 4,
            min_speed_m_s: 0.05,
            free_margin: 0.5,
        }
    }
}

/// A* on a grid, and the dynamic window approach towards a point of the path.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PlannerParameters {
    /// Side of a cell, 0.05 to 2 keep-out distances. Maps of more than 200,000 cells get larger cells.
    pub cell: f32,
    /// Distance beyond the keep-out distance that a path keeps from walls and obstacles if it can, 0 to 10 keep-out distances.
    pub margin: f32,
    /// Control steps between two plans, 1 to 1,000.
    pub replan_steps: u32,
    /// Largest distance along the path to the point to steer for, 0.1 to 100 keep-out distances.
    pub lookahead: f32,
    /// The dynamic window approach.
    pub dwa: DwaParameters,
}

impl Default for PlannerParameters {
    fn default() -> Self {
        let dwa = DwaParameters { margin: 0.1, ..DwaParameters::default() };
        Self { cell: 0.34, margin: 1.0, replan_steps: 3, lookahead: 3.0, dwa }
    }
}

/// A* on the true map and pure pursuit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct AstarParameters {
    /// Side of a cell, 0.05 to 2 keep-out distances. Maps of more than 200,000 cells get larger cells.
    pub cell: f32,
    /// Distance beyond the keep-out distance that a path keeps from walls and obstacles if it can, 0 to 10 keep-out distances.
    pub margin: f32,
    /// Control steps between two plans, 1 to 1,000.
    pub replan_steps: u32,
    /// Largest distance along the path to the point to pursue, 0.1 to 100 keep-out distances.
    pub lookahead: f32,
}

impl Default for AstarParameters {
    fn default() -> Self {
        Self { cell: 0.34, margin: 1.0, replan_steps: 3, lookahead: 1.5 }
    }
}

/// Optimal reciprocal collision avoidance. Moving obstacles are discs to it, with their true velocities.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct OrcaParameters {
    /// Time for which no collision with moving obstacles is allowed, 0.1 to 60 s.
    pub time_horizon_s: f32,
    /// The same for walls and static obstacles, 0.1 to 60 s.
    pub static_horizon_s: f32,
    /// Fraction of the avoidance that the robot takes on itself, 0 to 1: 0.5 if the others avoid it in the same way, 1 if they
    /// do nothing.
    pub responsibility: f32,
    /// Distance to keep beyond the keep-out distance, 0 to 10 keep-out distances.
    pub margin: f32,
    /// Time to turn to the direction of the velocity, 0.001 to 100 s.
    pub turn_time_s: f32,
}

impl Default for OrcaParameters {
    fn default() -> Self {
        Self {
            time_horizon_s: 5.0,
            static_horizon_s: 1.0,
            responsibility: 0.5,
            margin: 0.05,
            turn_time_s: 0.4,
        }
    }
}

impl DriverConfig {
    /// The names of the shipped drivers.
    pub const NAMES: [&str; 7] = ["field", "dwa", "dwa-cv", "grid-dwa", "astar-dwa", "astar", "orca"];

    /// The shipped driver `name`, with the default parameters.
    #[must_use]
    pub fn shipped(name: &str) -> Option<Self> {
        let all = [
            Self::Field(FieldParameters::default()),
            Self::Dwa(DwaParameters::default()),
            Self::DwaCv(TrackingParameters::default()),
            Self::GridDwa(PlannerParameters::default()),
            Self::AstarDwa(PlannerParameters::default()),
            Self::Astar(AstarParameters::default()),
            Self::Orca(OrcaParameters::default()),
        ];
        all.into_iter().find(|driver| driver.name() == name)
    }

    /// The checked driver in `text`, the contents of the file at `path`.
    ///
    /// # Errors
    /// The text is not a driver, or a value is out of range; the message lists all problems.
    pub fn parse(text: &str, path: impl AsRef<Path>) -> Result<Self, FileError> {
        parse_checked(text, path, |driver, _| Self::diagnostics(driver), Self::diagnostics)
    }

    /// Whether the text of a RON file is meant as a driver: whether it begins with the name of a variant.
    #[must_use]
    pub fn looks_like(text: &str) -> bool {
        let variants = ["Field", "Dwa", "DwaCv", "GridDwa", "AstarDwa", "Astar", "Orca"];
        variants.into_iter().any(|name| resemblance::<Self>(text, name) > 0)
    }

    /// Its name, one of [`DriverConfig::NAMES`].
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Field(_) => "field",
            Self::Dwa(_) => "dwa",
            Self::DwaCv(_) => "dwa-cv",
            Self::GridDwa(_) => "grid-dwa",
            Self::AstarDwa(_) => "astar-dwa",
            Self::Astar(_) => "astar",
            Self::Orca(_) => "orca",
        }
    }

    /// Its name in full, for displays.
    #[must_use]
    pub fn title(&self) -> &'static str {
        match self {
            Self::Field(_) => "Potential field",
            Self::Dwa(_) => "DWA",
            Self::DwaCv(_) => "DWA with velocities",
            Self::GridDwa(_) => "A* and DWA on its own map",
            Self::AstarDwa(_) => "A* and DWA on the true map",
            Self::Astar(_) => "A* and pure pursuit",
            Self::Orca(_) => "ORCA",
        }
    }

    /// What it may perceive.
    #[must_use]
    pub fn class(&self) -> DriverClass {
        match self {
            Self::Field(_) | Self::Dwa(_) | Self::DwaCv(_) => DriverClass::A,
            Self::GridDwa(_) => DriverClass::B,
            Self::AstarDwa(_) | Self::Astar(_) | Self::Orca(_) => DriverClass::C,
        }
    }

    /// A driver of `robot` for one episode.
    #[must_use]
    pub fn driver(&self, robot: &Robot) -> Box<dyn Driver> {
        let robot = robot.clone();
        match *self {
            Self::Field(parameters) => Box::new(Field { robot, parameters }),
            Self::Dwa(parameters) => Box::new(DwaDriver::new(robot, parameters)),
            Self::DwaCv(parameters) => Box::new(TrackingDwaDriver::new(robot, parameters)),
            Self::GridDwa(p) => {
                let map = RollingMap::new(&robot, p.cell, p.margin);
                Box::new(Planned::new(map, Steering::Dwa(p.dwa), robot, &p))
            }
            Self::AstarDwa(p) => {
                let map = TrueMap::new(&robot, &p);
                Box::new(Planned::new(map, Steering::Dwa(p.dwa), robot, &p))
            }
            Self::Astar(AstarParameters { cell, margin, replan_steps, lookahead }) => {
                let p = PlannerParameters {
                    cell,
                    margin,
                    replan_steps,
                    lookahead,
                    dwa: DwaParameters::default(),
                };
                Box::new(Planned::new(TrueMap::new(&robot, &p), Steering::Pursuit, robot, &p))
            }
            Self::Orca(parameters) => Box::new(OrcaDriver { robot, parameters }),
        }
    }

    /// All invalid values.
    #[must_use]
    pub fn diagnostics(&self) -> Vec<Diagnostic> {
        let checks = match self {
            Self::Field(p) => vec![
                within("repulsion", p.repulsion, 0.0..=1000.0),
                within("influence_distance", p.influence_distance, 0.1..=100.0),
                within_above_zero("slow_distance", p.slow_distance, 100.0),
                within("turn_time_s", p.turn_time_s, 0.001..=100.0),
            ],
            Self::Dwa(p) => p.checks("").into(),
            Self::DwaCv(p) => {
                let own = [
                    within("max_extent", p.max_extent, 0.1..=100.0),
                    within("link", p.link, 1.0..=100.0),
                    within_above_zero("position_gain", p.position_gain, 1.0),
                    within_above_zero("velocity_gain", p.velocity_gain, 1.0),
                    within("min_scans", p.min_scans, 2..=100),
                    within("min_speed_m_s", p.min_speed_m_s, 0.0..=5.0),
                    within("free_margin", p.free_margin, 0.0..=100.0),
                ];
                [&own[..], &p.dwa.checks("dwa.")].concat()
            }
            Self::GridDwa(p) | Self::AstarDwa(p) => {
                let planner = planner_checks(p.cell, p.margin, p.replan_steps, p.lookahead);
                [&planner[..], &p.dwa.checks("dwa.")].concat()
            }
            Self::Astar(p) => planner_checks(p.cell, p.margin, p.replan_steps, p.lookahead).into(),
            Self::Orca(p) => vec![
                within("time_horizon_s", p.time_horizon_s, 0.1..=60.0),
                within("static_horizon_s", p.static_horizon_s, 0.1..=60.0),
                within("responsibility", p.responsibility, 0.0..=1.0),
                within("margin", p.margin, 0.0..=10.0),
                within("turn_time_s", p.turn_time_s, 0.001..=100.0),
            ],
        };
        let errors = checks.into_iter().filter_map(Result::err);
        errors.map(|error| Diagnostic { path: error.field, message: error.problem }).collect()
    }
}

type Check = Result<(), wayfield_policy::range::ConfigError>;

fn planner_checks(cell: f32, margin: f32, replan_steps: u32, lookahead: f32) -> [Check; 4] {
    [
        within("cell", cell, 0.05..=2.0),
        within("margin", margin, 0.0..=10.0),
        within("replan_steps", replan_steps, 1..=1000),
        within("lookahead", lookahead, 0.1..=100.0),
    ]
}

impl DwaParameters {
    /// The checks of its values. `prefix` comes before the names of the fields in errors.
    fn checks(&self, prefix: &str) -> [Check; 7] {
        let name = |field: &str| format!("{prefix}{field}");
        [
            within(&name("horizon_s"), self.horizon_s, 0.1..=60.0),
            within(&name("heading_time_s"), self.heading_time_s, 0.001..=60.0),
            within(&name("heading"), self.heading, 0.0..=1000.0),
            within(&name("clearance"), self.clearance, 0.0..=1000.0),
            within(&name("speed"), self.speed, 0.0..=1000.0),
            within(&name("margin"), self.margin, 0.0..=10.0),
            within(&name("memory_s"), self.memory_s, 0.0..=1.0),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_that_of_a_driver_with_valid_parameters() {
        for name in DriverConfig::NAMES {
            let driver = DriverConfig::shipped(name).unwrap_or_else(|| panic!("{name}"));
            assert_eq!((driver.name(), driver.diagnostics()), (name, Vec::new()));
        }
        assert_eq!(DriverConfig::shipped("policy"), None);
    }

    #[test]
    fn a_file_is_meant_as_a_driver_if_it_begins_with_the_name_of_one() {
        for (text, expected) in [
            ("DwaCv(min_scans: 5)", true),
            ("// for the hall\nField()", true),
            ("(name: \"Dwa\", obstacles: [])", false),
            ("Scenario(name: \"a\")", false),
            ("Dwarf()", false),
        ] {
            assert_eq!(DriverConfig::looks_like(text), expected, "{text}");
        }
        let error = DriverConfig::parse("Field(repulsion: -1.0)", "field.ron").unwrap_err().to_string();
        assert!(error.starts_with("field.ron:1:18: ") && error.contains("give 0 to 1000"), "{error}");
    }

    #[test]
    fn a_value_out_of_range_is_named_with_its_range() {
        let dwa = DwaParameters { memory_s: 2.0, ..DwaParameters::default() };
        let tracking = TrackingParameters { dwa, velocity_gain: 0.0, ..TrackingParameters::default() };
        let problems: Vec<String> =
            DriverConfig::DwaCv(tracking).diagnostics().iter().map(ToString::to_string).collect();
        assert_eq!(
            problems,
            [
                "`velocity_gain` is 0; help: give a number above 0, at most 1",
                "`dwa.memory_s` is 2; help: give 0 to 1"
            ]
        );
    }
}
