//! The fields of the robot, its LIDAR and the task.

use egui::Ui;

use super::controls::{button_row_ui, choice_ui};
use super::fields::FieldRows;
use super::number::NumberSpec;
use super::obstacle_fields::described_rows;
use crate::app::editor::Editor;
use crate::scenario::limits::*;
use crate::scenario::{Motion, OdometryDrift, Ranged, Robot, Shape, Slip};

/// A full turn, exactly as in the schema's default.
const FULL_TURN_RAD: f32 = std::f32::consts::TAU;

/// The shapes of a robot: the name of the [template](Shape::templates), the text and the tooltip of each.
const SHAPES: [(&str, &str, &str); 4] = [
    ("Circle", "Disc", "Turns in place without touching anything new"),
    ("Box", "Box", "A rectangle around the origin"),
    ("Capsule", "Capsule", "A rectangle with round ends"),
    ("Hexagon", "Polygon", "Any convex polygon around the origin"),
];

/// The name of the template for the shape of a robot.
fn shape_name(shape: Option<&Shape>) -> &'static str {
    match shape {
        None | Some(Shape::Circle { .. }) => "Circle",
        Some(Shape::Rectangle { .. }) => "Box",
        Some(Shape::Capsule { .. }) => "Capsule",
        Some(Shape::Polygon { .. }) => "Hexagon",
    }
}

/// Shows the fields of the robot.
pub fn robot_ui(ui: &mut Ui, editor: &mut Editor) {
    let mut robot = editor.scenario().robot.clone();
    let mut rows = FieldRows::new(ui);
    let kind = choice_ui(rows.ui, "Body", shape_name(robot.shape.as_ref()), &SHAPES);
    match &mut robot.shape {
        None => rows.number("Radius", "", &mut robot.radius_m, NumberSpec::length(ROBOT_RADIUS_M)),
        Some(shape) => described_rows(&mut rows, shape.fields_mut()),
    }
    if let Some(kind) = kind {
        let template = Shape::templates().into_iter().find(|(name, _)| *name == kind);
        robot.shape = template.map(|(_, shape)| shape).filter(Shape::has_orientation);
        robot.radius_m = Robot::default().radius_m;
        rows.mark_changed("shape");
    }
    let mut turning_radius_m = robot.min_turning_radius_m.unwrap_or(0.0);
    let tip = "Minimum turning radius of a robot that steers like a car; 0 if it can turn on the spot";
    let radius = NumberSpec::length(0.0..=*TURNING_RADIUS_M.end());
    rows.number("Min. turning radius", tip, &mut turning_radius_m, radius);
    robot.min_turning_radius_m = (turning_radius_m != 0.0).then_some(turning_radius_m);
    let tip = "Time constant with which the robot follows its motion commands";
    rows.ranged("Actuator lag", tip, &mut robot.actuator_lag_s, NumberSpec::seconds(ACTUATOR_LAG_S));
    limit_row(
        &mut rows,
        "Limit acceleration",
        &mut robot.max_acceleration_m_s2,
        NumberSpec::acceleration(ACCELERATION_M_S2),
    );
    limit_row(
        &mut rows,
        "Limit angular acceleration",
        &mut robot.max_angular_acceleration_rad_s2,
        NumberSpec::angular_acceleration(ANGULAR_ACCELERATION_RAD_S2),
    );
    slip_rows(&mut rows, &mut robot.slip);
    odometry_rows(&mut rows, &mut robot.odometry_drift);
    let units = [NumberSpec::VELOCITY, NumberSpec::ANGULAR_VELOCITY];
    rows.list("Motion", &mut robot.motions, *MOTIONS.start(), "edit them in the file", units, |motion| {
        [("speed", &mut motion.v_m_s), ("turning rate", &mut motion.w_rad_s)]
    });
    if robot.motions.len() < *MOTIONS.end()
        && button_row_ui(rows.ui, &[("Add motion", "Add an action that the policy can choose", true)])
            == Some(0)
    {
        robot.motions.push(Motion { v_m_s: 0.15, w_rad_s: 0.0 });
        rows.mark_changed("motion added");
    }
    rows.commit(editor, "robot", |scenario| scenario.robot = robot);
}

/// A checkbox for the slip of the wheels and, if they slip, its parameters.
fn slip_rows(rows: &mut FieldRows<'_>, slip: &mut Option<Slip>) {
    let mut slips = slip.is_some();
    rows.checkbox("Wheels slip", "The robot moves less than its wheels", &mut slips);
    match slip {
        Some(Slip { forward, turning, std }) if slips => {
            let spec = NumberSpec::FRACTION.with_range(SLIP);
            rows.ranged("Slip forward", "Fraction of the wheels' speed that is lost", forward, spec);
            rows.ranged("Slip in turns", "Fraction of the wheels' turning rate that is lost", turning, spec);
            let spec = spec.with_range(SLIP_STD);
            rows.ranged("Slip variation", "Standard deviation from step to step", std, spec);
        }
        _ => *slip = slips.then(Slip::default),
    }
}

/// A checkbox for the drift of odometry and, if it drifts, its errors.
fn odometry_rows(rows: &mut FieldRows<'_>, drift: &mut Option<OdometryDrift>) {
    let mut drifts = drift.is_some();
    let tip = "The robot observes the goal from the pose that its odometry gives";
    rows.checkbox("Odometry drifts", tip, &mut drifts);
    match drift {
        Some(OdometryDrift { distance_error, rotation_error, heading_drift_rad_m }) if drifts => {
            let error = NumberSpec::FRACTION.with_range(ODOMETRY_ERROR);
            rows.ranged("Distance error", "Per metre driven", distance_error, error);
            rows.ranged("Rotation error", "Per radian turned", rotation_error, error);
            let drift = NumberSpec::heading_drift(HEADING_DRIFT_RAD_M);
            rows.ranged("Heading drift", "Rotation reported per metre", heading_drift_rad_m, drift);
        }
        _ => {
            let error = Ranged::Number(0.02);
            let new = OdometryDrift {
                distance_error: error,
                rotation_error: error,
                heading_drift_rad_m: Ranged::Number(0.0),
            };
            *drift = drifts.then_some(new);
        }
    }
}

/// A checkbox for a limit and, if there is one, its value.
fn limit_row(rows: &mut FieldRows<'_>, name: &str, limit: &mut Option<f32>, spec: NumberSpec) {
    let mut is_limited = limit.is_some();
    rows.checkbox(name, "Otherwise the drive changes its speed at once, apart from the lag", &mut is_limited);
    match limit {
        Some(limit) if is_limited => rows.number("At most", "When speeding up and when braking", limit, spec),
        _ => *limit = is_limited.then_some(1.0),
    }
}

/// Shows the fields of the LIDAR.
pub fn lidar_ui(ui: &mut Ui, editor: &mut Editor) {
    let mut lidar = editor.scenario().lidar.clone();
    let mut rows = FieldRows::new(ui);
    rows.count("Beams", "Evenly distributed over the field of view", &mut lidar.beams, BEAMS);
    let view = NumberSpec::ANGLE.with_range(FIELD_OF_VIEW_RAD);
    rows.number("Field of view", "Centred on the heading", &mut lidar.field_of_view_rad, view);
    if lidar.is_all_around() {
        lidar.field_of_view_rad = FULL_TURN_RAD;
    }
    let tip = "Largest range; also reported by beams that hit nothing";
    rows.number("Range", tip, &mut lidar.max_range_m, NumberSpec::length(LIDAR_RANGE_M));
    let tip = "Standard deviation of the Gaussian noise on each range";
    rows.ranged("Noise", tip, &mut lidar.noise_std_m, NumberSpec::length(LIDAR_NOISE_M));
    let tip = "Probability that a beam is lost and reports the largest range";
    rows.ranged("Dropout", tip, &mut lidar.dropout, NumberSpec::FRACTION);
    let tip = "Age of a scan when the policy sees it";
    rows.ranged_count("Latency in steps", tip, &mut lidar.latency_steps, LIDAR_LATENCY_STEPS);
    rows.commit(editor, "lidar", |scenario| scenario.lidar = lidar);
}

/// Shows the fields of the task.
pub fn task_ui(ui: &mut Ui, editor: &mut Editor) {
    let mut task = editor.scenario().task.clone();
    let mut rows = FieldRows::new(ui);
    let tip = "The goal is reached within this distance";
    rows.number("Goal radius", tip, &mut task.goal_radius_m, NumberSpec::length(GOAL_RADIUS_M));
    let tip = "An obstacle this close to the robot's centre counts as a collision; must exceed the radius of a disc";
    rows.number("Collision range", tip, &mut task.collision_range_m, NumberSpec::length(COLLISION_RANGE_M));
    let tip = "Smallest distance from the robot to a new goal";
    let distance = NumberSpec::length(GOAL_DISTANCE_M);
    rows.number("Min. goal distance", tip, &mut task.min_goal_distance_m, distance);
    let tip = "Longest episode";
    rows.count("Time limit in steps", tip, &mut task.max_episode_steps, EPISODE_STEPS);
    let tip = "Simulated time of one step";
    rows.number("Control period", tip, &mut task.control_period_s, NumberSpec::seconds(CONTROL_PERIOD_S));
    rows.commit(editor, "task", |scenario| scenario.task = task);
}
