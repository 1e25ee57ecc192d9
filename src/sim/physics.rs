//! All of bevy_rapier stands here: its plugin, how bodies are made, and the step of its contexts.
//!
//! Every arena is a physics context of its own, so arenas cannot meet, and arena k moves the same bits whatever the
//! number of arenas. In: a scenario's shapes. Out: [`Bodies`], the handles by which the other files of this room
//! command and read rapier's bodies directly.
//!
//! bevy_rapier's `SyncBackend` systems make bodies and colliders from components when arenas are spawned; in a
//! control step [`step`] steps its contexts, with one [`Pipeline`] for all of them. Copying every pose into a
//! `Transform` and back each step would cost more than the step, and lose bits on the way; whoever draws reads
//! [`Pose`](crate::task::Pose).

use bevy::ecs::schedule::{Schedule, ScheduleLabel, SingleThreadedExecutor};
use bevy::prelude::*;
use bevy::transform::TransformPlugin;
use bevy_rapier2d::prelude::*;
use bevy_rapier2d::rapier::geometry::ConvexPolygon;
use bevy_rapier2d::rapier::prelude::{ColliderHandle, PhysicsPipeline, RigidBodyHandle, SharedShape};

use crate::control_step::{ControlSet, ControlStep};
use crate::scenario::{Enclosure, Obstacle, ObstacleMotion, Scenario, Shape, polygon, pose_at};

/// Runs when arenas have been spawned: makes rapier's bodies from the components.
#[derive(ScheduleLabel, Debug, Clone, PartialEq, Eq, Hash)]
struct MakeBodies;

/// The walls' thickness, in m: rapier itself lets little through it. (What it lets through, `contact.rs` stops.)
const WALL_M: f32 = 0.5;

/// How far ahead, in m, rapier may look for what a body would meet in the coming step: so that a
/// body mostly stops at a surface instead of in it. (`contact.rs` does the rest.)
const LOOK_AHEAD_M: f32 = 50.0;

/// The handles of what stands and moves in an arena's physics context. What stands still is a collider without a body:
/// rapier has that much less to look after.
#[derive(Component, Clone, Debug)]
pub struct Bodies {
    /// The robot.
    pub robot: RigidBodyHandle,
    /// One for each obstacle of the scenario, in its order; none for one that stands still.
    pub obstacles: Vec<Option<RigidBodyHandle>>,
    /// Colliders, enough for what the scenario's generators make; those that are not used are disabled.
    pub generated: Vec<ColliderHandle>,
    /// What a beam can meet: the obstacles in the scenario's order, then the walls, then what was generated.
    pub solids: Vec<ColliderHandle>,
}

/// What a body is in its arena; orders the handles.
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

/// The components of an arena's own entity that make it a physics context without gravity, stepped by
/// `control_period_s`.
///
/// One solver iteration is enough: rapier cuts a step into as many substeps, which help where contacts and joints
/// depend on each other. Here one disc meets one thing, once, and that ends its episode. A free robot goes its chord
/// in one sum instead of four, with one rounding, and a step costs an eighth less of rapier's time.
pub(super) fn context(control_period_s: f32) -> impl Bundle {
    let mut simulation = RapierContextSimulation::default();
    simulation.integration_parameters.dt = control_period_s;
    simulation.integration_parameters.num_solver_iterations = 1;
    (simulation, RapierConfiguration { gravity: Vec2::ZERO, ..RapierConfiguration::new(1.0) })
}

/// Rapier's working memory, one for all arenas: so it stays in the cache. What it keeps from step to step concerns joints,
/// of which there are none, and a flag that every arena with a robot sets anew. Where all robots are touched equally often
/// (`actuate` and `read_pose` do so in every step), rapier lays out its lack of joints once for all arenas.
#[derive(Resource, Default)]
struct Pipeline(PhysicsPipeline);

/// What a step of rapier reads and writes of an arena.
type Stepped = (
    &'static RapierConfiguration,
    &'static mut RapierContextSimulation,
    &'static mut RapierContextColliders,
    &'static mut RapierContextJoints,
    &'static mut RapierRigidBodySet,
);

/// `Simulate`: one step of every arena that is not parked.
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

/// Spawns the bodies of `scenario` for the arena `context`, in an order that depends on the scenario alone.
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
        let mut parts =
            world.spawn((Part::Obstacle(index), link, collider(&obstacle.shape), at(x, y, rotation)));
        if obstacle.motion != ObstacleMotion::Static {
            parts.insert(RigidBody::KinematicPositionBased);
        }
    }
    let inner = scenario.walls.iter().flat_map(wayfield_scenario::Wall::segments);
    let inner = inner.map(|Obstacle { shape, position_m: Vec2 { x, y }, rotation_rad, .. }| {
        (collider(&shape), at(x, y, rotation_rad))
    });
    for (index, (collider, at)) in around(&scenario.enclosure).into_iter().chain(inner).enumerate() {
        world.spawn((Part::Wall(index), link, collider, at));
    }
    for index in 0..scenario.max_obstacles() - scenario.obstacles.len() {
        // Shaped and placed, or disabled, when an episode begins. (Not here: all that has no body is then made in order.)
        world.spawn((Part::Generated(index), link, Collider::ball(1.0), at(0.0, 0.0, 0.0)));
    }
}

/// The colliders around the enclosure, and where they are. A rectangle has thick walls; any other outline its bare sides,
/// for thick ones would reach in where a corner points inwards.
fn around(enclosure: &Enclosure) -> Vec<(Collider, Transform)> {
    match *enclosure {
        Enclosure::Rectangle { width_m, height_m } => {
            let (w, h, t) = (width_m / 2.0, height_m / 2.0, WALL_M / 2.0);
            let long = w + WALL_M;
            [(w + t, 0.0, t, h), (-w - t, 0.0, t, h), (0.0, h + t, long, t), (0.0, -h - t, long, t)]
                .map(|(x, y, half_width, half_height)| {
                    (Collider::cuboid(half_width, half_height), Transform::from_xyz(x, y, 0.0))
                })
                .into()
        }
        Enclosure::Polygon { .. } => {
            let side = |(from, to): (Vec2, Vec2)| (Collider::segment(from, to), Transform::IDENTITY);
            polygon::sides(&enclosure.corners_m()).map(side).collect()
        }
    }
}

/// A shape about its middle, as bevy_rapier has it.
fn collider(shape: &Shape) -> Collider {
    match shape {
        Shape::Circle { radius_m } => Collider::ball(*radius_m),
        Shape::Rectangle { width_m, height_m } => Collider::cuboid(width_m / 2.0, height_m / 2.0),
        Shape::Capsule { length_m, radius_m } => Collider::capsule_x(length_m / 2.0, *radius_m),
        Shape::Polygon { corners_m } => {
            // Every corner is kept: parry would leave out those where the outline hardly bends. What it can't take encloses
            // nothing: the checks let no such thing through.
            let corners = polygon::counterclockwise(corners_m).into_iter().collect();
            ConvexPolygon::from_convex_polyline_unmodified(corners)
                .map_or_else(|| Collider::ball(0.001), |outline| SharedShape::new(outline).into())
        }
    }
}

/// The same as rapier has it, for colliders that are shaped anew.
pub(super) fn shape(shape: &Shape) -> SharedShape {
    collider(shape).raw
}

/// Makes rapier's bodies of all that was spawned, and gives each arena its [`Bodies`].
pub(super) fn make_bodies(world: &mut World) {
    world.run_schedule(MakeBodies);
    let mut found: Vec<(Entity, Part, Option<RigidBodyHandle>, ColliderHandle)> = world
        .query::<(&RapierContextEntityLink, &Part, Option<&RapierRigidBodyHandle>, &RapierColliderHandle)>()
        .iter(world)
        .map(|(link, part, body, collider)| (link.0, *part, body.map(|body| body.0), collider.0))
        .collect();
    found.sort_by_key(|&(arena, part, ..)| (arena, part));
    for parts in found.chunk_by(|a, b| a.0 == b.0) {
        // The robot, which always has a body, sorts first; then the obstacles in order, the walls, what is generated.
        let (arena, _, Some(robot), _) = parts[0] else { continue };
        let obstacle = |part: &Part| matches!(part, Part::Obstacle(_));
        let (standing, generated) =
            parts[1..].split_at(parts[1..].partition_point(|p| !matches!(p.1, Part::Generated(_))));
        world.entity_mut(arena).insert(Bodies {
            robot,
            obstacles: standing.iter().filter(|p| obstacle(&p.1)).map(|p| p.2).collect(),
            generated: generated.iter().map(|p| p.3).collect(),
            solids: standing.iter().map(|p| p.3).collect(),
        });
    }
}

/// Takes away every arena and body.
pub(super) fn despawn_all(world: &mut World) {
    let mut all: Vec<Entity> =
        world.query_filtered::<Entity, With<RapierContextEntityLink>>().iter(world).collect();
    all.extend(world.query_filtered::<Entity, With<RapierContextSimulation>>().iter(world));
    for entity in all {
        world.despawn(entity);
    }
    // bevy_rapier looks after removed bodies here; their contexts are gone with them.
    world.run_schedule(MakeBodies);
}
