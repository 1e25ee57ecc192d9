//! The interface to bevy_rapier: an arena's bodies and the physics step.
//!
//! In: a scenario's shapes. Out: [`Bodies`], the handles with which the other files of this module control and read
//! rapier's bodies directly. Every arena is a separate physics context, so arenas cannot interact, and arena k computes the
//! same bits for any number of arenas.
//!
//! Bodies and colliders are made in the sets of bevy_rapier's components ([`make_bodies`]), without an entity for each. In a
//! control step, [`step`] steps all contexts with one [`Pipeline`]. Poses are not copied into `Transform`s, because that would
//! cost more than the step and lose precision. Displays read [`Pose`](crate::task::Pose).

use std::collections::HashMap;
use std::sync::Arc;

use bevy::math::Vec3Swizzles;
use bevy::prelude::*;
use bevy_rapier2d::prelude::{
    RapierConfiguration, RapierContextColliders, RapierContextJoints, RapierContextSimulation,
    RapierRigidBodySet,
};
use bevy_rapier2d::rapier::dynamics::{LockedAxes, MassProperties, RigidBodyBuilder};
use bevy_rapier2d::rapier::math::Pose as BodyPose;
use bevy_rapier2d::rapier::prelude::{
    ColliderBuilder, ColliderHandle, PhysicsPipeline, RigidBody, RigidBodyHandle, SharedShape,
};

use super::colliders::{enclosure_colliders, shared_shape};
use super::footprint::Footprint;
use super::obstacles::place_bodies;
use super::static_shapes::StaticShapes;
use crate::control_step::{ControlSet, ControlStep};
use crate::scenario::{Obstacle, ObstacleMotion, Robot, Scenario, Wall, pose_at};
use crate::task::{ArenaLayout, Clock, Pedestrians};

/// The prediction distance of rapier's soft CCD, in m. With it, most bodies stop at a surface instead of inside it;
/// `contact.rs` handles the others.
const LOOK_AHEAD_M: f32 = 50.0;

/// The handles of the bodies and colliders in an arena's physics context. A static obstacle is a collider without a
/// body, which costs rapier less.
#[derive(Component, Clone, Debug)]
pub struct Bodies {
    /// The scenario as written, from which the bodies were made.
    pub scenario: Arc<Scenario>,
    /// The robot.
    pub robot: RigidBodyHandle,
    /// The bodies of the scenario's obstacles, in the scenario's order; `None` for a static obstacle.
    pub obstacles: Vec<Option<RigidBodyHandle>>,
    /// The bodies in `obstacles`, each with its index there.
    pub(super) moving: Vec<(RigidBodyHandle, usize)>,
    /// The colliders reserved for generated obstacles. Those that the current layout does not use are disabled.
    pub generated: Vec<ColliderHandle>,
    /// Everything that beams and the robot can hit: the obstacles in the scenario's order, then the walls, then the
    /// generated obstacles.
    pub solids: Vec<ColliderHandle>,
    /// The footprint of a robot that is not a disc.
    pub(super) footprint: Option<Footprint>,
    /// The static solids in a grid, if there are many.
    pub(super) static_shapes: Option<Arc<StaticShapes>>,
    /// The indices into `solids` of the solids that are not in the grid.
    pub(super) not_in_grid: Vec<usize>,
}

/// Adds the physics step to [`ControlStep`].
pub(super) fn build(app: &mut App) {
    app.init_resource::<Pipeline>().add_systems(ControlStep, step.in_set(ControlSet::Simulate));
}

/// The components that make an arena's entity a physics context without gravity, with its bodies.
pub(super) fn context(ArenaBodies { bodies, set, colliders }: ArenaBodies) -> impl Bundle {
    let configuration = RapierConfiguration { gravity: Vec2::ZERO, ..RapierConfiguration::new(1.0) };
    let period_s = bodies.scenario.task.control_period_s;
    (bodies, simulation(period_s), configuration, set, colliders)
}

/// The bodies of an arena before its first step: the same in all arenas of a scenario.
#[derive(Clone)]
pub(super) struct ArenaBodies {
    bodies: Bodies,
    set: RapierRigidBodySet,
    colliders: RapierContextColliders,
}

impl ArenaBodies {
    /// Makes the bodies of `scenario`.
    pub(super) fn new(scenario: &Arc<Scenario>) -> Self {
        let (mut set, mut colliders) = (RapierRigidBodySet::default(), RapierContextColliders::default());
        let mut bodies = make_bodies(scenario, &mut set, &mut colliders);
        bodies.index_solids(&colliders.colliders, scenario.lidar.max_range_m);
        Self { bodies, set, colliders }
    }
}

/// The bodies of scenarios that arenas have switched to, kept so that they are made only once. The key is the address of the
/// scenario, which the bodies keep alive.
#[derive(Default)]
pub(super) struct KeptBodies(HashMap<usize, ArenaBodies>);

impl KeptBodies {
    /// Maximum number of scenarios whose bodies are kept.
    const MAX: usize = 1_024;

    /// Replaces an arena's bodies if its scenario has changed, and returns whether it has. Nothing of the old ones remains, so
    /// that rapier computes the same bits as in a new arena. Moving obstacles are at their poses of step 0.
    pub(super) fn replace(
        &mut self,
        layout: &ArenaLayout,
        bodies: &mut Bodies,
        context: &mut RapierContextSimulation,
        set: &mut RapierRigidBodySet,
        colliders: &mut RapierContextColliders,
    ) -> bool {
        if Arc::ptr_eq(&bodies.scenario, &layout.written) {
            return false;
        }
        if self.0.len() >= Self::MAX {
            self.0.clear();
        }
        let address = Arc::as_ptr(&layout.written) as usize;
        let new = self.0.entry(address).or_insert_with(|| ArenaBodies::new(&layout.written)).clone();
        *context = simulation(layout.written.task.control_period_s);
        (*bodies, *set, *colliders) = (new.bodies, new.set, new.colliders);
        true
    }
}

/// The components of an arena that [`replace_bodies`] reads and writes.
type Replaced = (
    &'static Clock,
    &'static Pedestrians,
    &'static ArenaLayout,
    &'static mut Bodies,
    &'static mut RapierContextSimulation,
    &'static mut RapierRigidBodySet,
    &'static mut RapierContextColliders,
);

/// In `ResetSet::Place`: replaces the bodies of every arena whose scenario has changed, and places its moving obstacles
/// at their poses at the time of the arena's clock, which is not reset.
pub(super) fn replace_bodies(mut kept: Local<KeptBodies>, mut arenas: Query<Replaced>) {
    for (clock, pedestrians, layout, mut bodies, mut context, mut set, mut colliders) in &mut arenas {
        if kept.replace(layout, &mut bodies, &mut context, &mut set, &mut colliders) {
            place_bodies(layout.indexed(pedestrians), *clock, &bodies, &mut set, &mut colliders);
        }
    }
}

/// The state of a physics context with steps of `control_period_s`.
///
/// One solver iteration is enough. Rapier divides a step into as many substeps as iterations, which helps if contacts and
/// joints depend on each other. Here a single disc touches something once, and that ends its episode. With one
/// iteration, a free robot's translation is rounded once instead of four times, and rapier's step takes an eighth less time.
fn simulation(control_period_s: f32) -> RapierContextSimulation {
    let mut simulation = RapierContextSimulation::default();
    simulation.integration_parameters.dt = control_period_s;
    simulation.integration_parameters.num_solver_iterations = 1;
    simulation
}

/// Rapier's working memory, shared by all arenas so that it stays in the cache.
///
/// Between steps it keeps only data about joints, of which there are none, and a flag that every arena with a robot sets
/// again. Rapier rebuilds its (empty) joint data for an arena whose bodies have been modified more or less often than those
/// of the arena before it. `actuate` and `read_pose` modify all robots equally often, so once is enough for all arenas.
#[derive(Resource, Default)]
struct Pipeline(PhysicsPipeline);

/// The components of an arena that a physics step reads and writes.
type Stepped = (
    &'static RapierConfiguration,
    &'static mut RapierContextSimulation,
    &'static mut RapierContextColliders,
    &'static mut RapierContextJoints,
    &'static mut RapierRigidBodySet,
);

/// In `ControlSet::Simulate`: steps the physics of every active arena.
fn step(mut pipeline: ResMut<Pipeline>, mut arenas: Query<Stepped>) {
    for (configuration, mut simulation, mut colliders, mut joints, mut set) in &mut arenas {
        if !configuration.physics_pipeline_active {
            continue;
        }
        let simulation = &mut *simulation;
        let joints = &mut *joints;
        pipeline.0.step(
            configuration.gravity,
            &simulation.integration_parameters,
            &mut simulation.islands,
            &mut simulation.broad_phase,
            &mut simulation.narrow_phase,
            &mut set.bodies,
            &mut colliders.colliders,
            &mut joints.impulse_joints,
            &mut joints.multibody_joints,
            &mut simulation.ccd_solver,
            &(),
            &(),
        );
    }
}

/// Makes the bodies and colliders of `scenario` in the empty sets of an arena.
///
/// Rapier's results depend on the order of insertion, which depends on the scenario alone: everything static, the
/// robot, then the moving obstacles.
fn make_bodies(
    scenario: &Arc<Scenario>,
    set: &mut RapierRigidBodySet,
    colliders: &mut RapierContextColliders,
) -> Bodies {
    let (bodies, colliders) = (&mut set.bodies, &mut colliders.colliders);
    let period_s = scenario.task.control_period_s;
    let (own, mut obstacles) = (&scenario.obstacles, vec![None; scenario.obstacles.len()]);
    let mut solids = vec![ColliderHandle::invalid(); own.len()];
    for (index, obstacle) in own.iter().enumerate().filter(|(_, obstacle)| !is_moving(obstacle)) {
        solids[index] =
            colliders.insert(static_collider(shared_shape(&obstacle.shape), pose_at(obstacle, 0, period_s)));
    }
    let inner = scenario.walls.iter().flat_map(Wall::pieces);
    let inner = inner.map(|Obstacle { shape, position_m: Vec2 { x, y }, rotation_rad, .. }| {
        (shared_shape(&shape), (x, y, rotation_rad))
    });
    for (shape, pose) in enclosure_colliders(&scenario.enclosure).into_iter().chain(inner) {
        solids.push(colliders.insert(static_collider(shape, pose)));
    }
    // Placeholders. Their shapes and poses are set when an episode begins, or they are disabled.
    let placeholder = || static_collider(SharedShape::ball(1.0), (0.0, 0.0, 0.0));
    let reserved = scenario.max_obstacles() - own.len();
    let generated = (0..reserved).map(|_| colliders.insert(placeholder())).collect();
    let robot = bodies.insert(robot_body(&scenario.robot));
    colliders.insert_with_parent(robot_collider(&scenario.robot), robot, bodies);
    for (index, obstacle) in own.iter().enumerate().filter(|(_, obstacle)| is_moving(obstacle)) {
        let pose = body_pose(pose_at(obstacle, 0, period_s));
        let body = bodies.insert(RigidBodyBuilder::kinematic_position_based().pose(pose));
        let shape = ColliderBuilder::new(shared_shape(&obstacle.shape));
        (obstacles[index], solids[index]) = (Some(body), colliders.insert_with_parent(shape, body, bodies));
    }
    let (scenario, footprint) = (scenario.clone(), Footprint::of(&scenario.robot));
    let moving = obstacles.iter().enumerate().filter_map(|(index, body)| Some(((*body)?, index))).collect();
    let (static_shapes, not_in_grid) = (None, Vec::new());
    Bodies { scenario, robot, obstacles, moving, generated, solids, footprint, static_shapes, not_in_grid }
}

fn is_moving(obstacle: &Obstacle) -> bool {
    obstacle.motion != ObstacleMotion::Static
}

/// The collider of something static at a pose, in m and rad.
fn static_collider(shape: SharedShape, pose: (f32, f32, f32)) -> ColliderBuilder {
    ColliderBuilder::new(shape).position(body_pose(pose))
}

/// The robot's collider. Rapier stops a disc; any other shape is a sensor, which `footprint.rs` stops. The centre of mass is
/// the robot's origin.
fn robot_collider(robot: &Robot) -> ColliderBuilder {
    let Some(shape) = &robot.shape else { return ColliderBuilder::ball(robot.radius_m).friction(0.0) };
    let shape = shared_shape(shape);
    let own = shape.mass_properties(1.0);
    let about_origin = MassProperties::new(Vec2::ZERO, own.mass(), own.principal_inertia());
    ColliderBuilder::new(shape).sensor(true).mass_properties(about_origin)
}

/// The robot's body at the origin: it does not turn in a contact, and never sleeps.
fn robot_body(robot: &Robot) -> RigidBody {
    let mut body = RigidBodyBuilder::dynamic()
        .locked_axes(LockedAxes::ROTATION_LOCKED)
        .soft_ccd_prediction(if robot.shape.is_none() { LOOK_AHEAD_M } else { 0.0 })
        .sleeping(false)
        .build();
    let activation = body.activation_mut();
    (activation.normalized_linear_threshold, activation.angular_threshold) = (-1.0, -1.0);
    body
}

/// Converts a pose in m and rad to rapier's. The rotation is rounded as in Bevy's transforms; other rounding would change
/// results.
fn body_pose((x, y, rotation_rad): (f32, f32, f32)) -> BodyPose {
    let local = Transform::from_xyz(x, y, 0.0).with_rotation(Quat::from_rotation_z(rotation_rad));
    let global = GlobalTransform::from(local).compute_transform();
    BodyPose::new(global.translation.xy(), global.rotation.to_scaled_axis().z)
}
