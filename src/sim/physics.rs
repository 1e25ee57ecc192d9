//! The interface to bevy_rapier: its plugin, the creation of bodies, and the physics step.
//!
//! In: a scenario's shapes. Out: [`Bodies`], the handles with which the other files of this module control and read
//! rapier's bodies directly. Every arena is a separate physics context, so arenas cannot interact, and arena k computes the
//! same bits for any number of arenas.
//!
//! bevy_rapier's `SyncBackend` systems make bodies and colliders from components when arenas are spawned. In a control
//! step, [`step`] steps all contexts with one [`Pipeline`]. Poses are not copied into `Transform`s, because that would cost
//! more than the step and lose precision. Displays read [`Pose`](crate::task::Pose).

use std::sync::Arc;

use bevy::ecs::schedule::{Schedule, ScheduleLabel, SingleThreadedExecutor};
use bevy::prelude::*;
use bevy::transform::TransformPlugin;
use bevy_rapier2d::prelude::*;
use bevy_rapier2d::rapier::prelude::{ColliderHandle, PhysicsPipeline, RigidBodyHandle};

use super::colliders::{collider, enclosure_colliders};
use super::still_shapes::{SharedGrids, StillShapes};
use crate::control_step::{ControlSet, ControlStep};
use crate::scenario::{Obstacle, ObstacleMotion, Scenario, pose_at};

/// The schedule that makes rapier's bodies from the components of spawned arenas.
#[derive(ScheduleLabel, Debug, Clone, PartialEq, Eq, Hash)]
struct MakeBodies;

/// The prediction distance of rapier's soft CCD, in m. With it, most bodies stop at a surface instead of inside it;
/// `contact.rs` handles the others.
const LOOK_AHEAD_M: f32 = 50.0;

/// The handles of the bodies and colliders in an arena's physics context. A static obstacle is a collider without a
/// body, which costs rapier less.
#[derive(Component, Clone, Debug)]
pub struct Bodies {
    /// The robot.
    pub robot: RigidBodyHandle,
    /// The bodies of the scenario's obstacles, in the scenario's order; None for a static obstacle.
    pub obstacles: Vec<Option<RigidBodyHandle>>,
    /// The colliders reserved for generated obstacles. Those that the current layout does not use are disabled.
    pub generated: Vec<ColliderHandle>,
    /// Everything that beams and the robot can hit: the obstacles in the scenario's order, then the walls, then the
    /// generated obstacles.
    pub solids: Vec<ColliderHandle>,
    /// The still solids in a grid, if there are many.
    pub(super) still: Option<Arc<StillShapes>>,
    /// The numbers in `solids` of those that are not in the grid.
    pub(super) not_in_grid: Vec<usize>,
}

/// The role of a body or collider in its arena. Its order is the order of the handles.
#[derive(Component, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Part {
    Robot,
    Obstacle(usize),
    Wall(usize),
    Generated(usize),
}

/// Installs rapier in [`ControlStep`].
pub(super) fn build(app: &mut App) {
    if !app.is_plugin_added::<TransformPlugin>() {
        app.add_plugins(TransformPlugin);
    }
    app.add_plugins(
        RapierPhysicsPlugin::<NoUserData>::default()
            .in_schedule(ControlStep)
            .with_default_system_setup(false)
            .with_custom_initialization(RapierContextInitialization::NoAutomaticRapierContext),
    );
    app.init_resource::<Pipeline>().add_systems(ControlStep, step.in_set(ControlSet::Simulate));
    let mut make = Schedule::new(MakeBodies);
    make.set_executor(SingleThreadedExecutor::new());
    make.add_systems(RapierPhysicsPlugin::<NoUserData>::get_systems(PhysicsSet::SyncBackend));
    app.add_schedule(make);
}

/// The components that make an arena's entity a physics context without gravity, with steps of `control_period_s`.
///
/// One solver iteration is enough. Rapier divides a step into as many substeps as iterations, which helps if contacts and
/// joints depend on each other. Here a single disc touches something once, and that ends its episode. With one
/// iteration, a free robot's translation is rounded once instead of four times, and rapier's step takes an eighth less time.
pub(super) fn context(control_period_s: f32) -> impl Bundle {
    let mut simulation = RapierContextSimulation::default();
    simulation.integration_parameters.dt = control_period_s;
    simulation.integration_parameters.num_solver_iterations = 1;
    (simulation, RapierConfiguration { gravity: Vec2::ZERO, ..RapierConfiguration::new(1.0) })
}

/// Rapier's working memory, shared by all arenas so that it stays in the cache.
///
/// Between steps it keeps only data about joints, of which there are none, and a flag that every arena with a robot sets
/// again. `actuate` and `read_pose` modify all robots equally often, so rapier sets up its empty joint data once for all
/// arenas.
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

/// `Simulate`: steps the physics of every active arena.
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

/// Spawns the bodies and colliders of `scenario` in the arena `context`, in an order that depends on the scenario alone.
pub(super) fn spawn_bodies(world: &mut World, scenario: &Scenario, context: Entity) {
    let link = RapierContextEntityLink(context);
    let at = |x: f32, y: f32, angle: f32| {
        Transform::from_xyz(x, y, 0.0).with_rotation(Quat::from_rotation_z(angle))
    };
    world.spawn((
        Part::Robot,
        link,
        RigidBody::Dynamic,
        Collider::ball(scenario.robot.radius_m),
        LockedAxes::ROTATION_LOCKED,
        Friction::coefficient(0.0),
        Sleeping::disabled(),
        SoftCcd { prediction: LOOK_AHEAD_M },
        at(0.0, 0.0, 0.0),
    ));
    let period_s = scenario.task.control_period_s;
    for (index, obstacle) in scenario.obstacles.iter().enumerate() {
        let (x, y, rotation) = pose_at(obstacle, 0, period_s);
        let mut entity =
            world.spawn((Part::Obstacle(index), link, collider(&obstacle.shape), at(x, y, rotation)));
        if obstacle.motion != ObstacleMotion::Static {
            entity.insert(RigidBody::KinematicPositionBased);
        }
    }
    let inner = scenario.walls.iter().flat_map(wayfield_scenario::Wall::segments);
    let inner = inner.map(|Obstacle { shape, position_m: Vec2 { x, y }, rotation_rad, .. }| {
        (collider(&shape), at(x, y, rotation_rad))
    });
    let walls = enclosure_colliders(&scenario.enclosure).into_iter().chain(inner);
    for (index, (collider, at)) in walls.enumerate() {
        world.spawn((Part::Wall(index), link, collider, at));
    }
    for index in 0..scenario.max_obstacles() - scenario.obstacles.len() {
        // A placeholder. Its shape and pose are set when an episode begins, or it is disabled. If it were disabled here,
        // rapier would not make the colliders without a body in this order.
        world.spawn((Part::Generated(index), link, Collider::ball(1.0), at(0.0, 0.0, 0.0)));
    }
}

/// Makes rapier's bodies and colliders from the spawned components, and adds [`Bodies`] to each arena.
pub(super) fn make_bodies(world: &mut World) {
    world.run_schedule(MakeBodies);
    let mut found: Vec<(Entity, Part, Option<RigidBodyHandle>, ColliderHandle)> = world
        .query::<(&RapierContextEntityLink, &Part, Option<&RapierRigidBodyHandle>, &RapierColliderHandle)>()
        .iter(world)
        .map(|(link, part, body, collider)| (link.0, *part, body.map(|body| body.0), collider.0))
        .collect();
    found.sort_by_key(|&(arena, part, ..)| (arena, part));
    let mut grids = SharedGrids::default();
    for parts in found.chunk_by(|a, b| a.0 == b.0) {
        // The robot, which always has a body, sorts first; then the obstacles, the walls and the generated obstacles.
        let (arena, _, Some(robot), _) = parts[0] else { continue };
        let is_obstacle = |part: &Part| matches!(part, Part::Obstacle(_));
        let (permanent, generated) =
            parts[1..].split_at(parts[1..].partition_point(|p| !matches!(p.1, Part::Generated(_))));
        let mut bodies = Bodies {
            robot,
            obstacles: permanent.iter().filter(|p| is_obstacle(&p.1)).map(|p| p.2).collect(),
            generated: generated.iter().map(|p| p.3).collect(),
            solids: permanent.iter().map(|p| p.3).collect(),
            still: None,
            not_in_grid: Vec::new(),
        };
        grids.index(world, arena, &mut bodies);
        world.entity_mut(arena).insert(bodies);
    }
}

/// Despawns all arenas and bodies.
pub(super) fn despawn_all(world: &mut World) {
    let mut all: Vec<Entity> =
        world.query_filtered::<Entity, With<RapierContextEntityLink>>().iter(world).collect();
    all.extend(world.query_filtered::<Entity, With<RapierContextSimulation>>().iter(world));
    for entity in all {
        world.despawn(entity);
    }
    // Lets bevy_rapier process the removed bodies.
    world.run_schedule(MakeBodies);
}
