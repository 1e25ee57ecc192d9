//! A headless simulation for tests, which choose the actions.
//!
//! In: a scenario, a number of arenas, a seed. Out: a [`Lab`] that steps, and gives access to states, outcomes and
//! physics. [`closed_form`] computes reference distances in f64 and without parry, [`large_worlds`] makes
//! scenarios with hundreds of shapes.
#![allow(dead_code, reason = "each test file uses some of the helpers")]

pub mod closed_form;
pub mod large_worlds;

use std::f32::consts::PI;
use std::sync::Arc;

use bevy::ecs::message::Messages;
use bevy::prelude::*;
use bevy_rapier2d::prelude::{RapierContextColliders, RapierRigidBodySet};
use wayfield::control_step::ControlStep;
use wayfield::random::{self, Stream};
use wayfield::scenario::{Generator, Obstacle, ObstacleMotion, RandomShape, Scenario, Shape};
use wayfield::sim::{self, Bodies, lidar};
use wayfield::simulation::{Simulation, SimulationBuilder};
use wayfield::task::{
    Actions, Arena, ArenaState, EpisodeEnded, ObservationLayout, Observations, Pose, RewardConfig,
    ScanMemory, SensorReadings, StepOutcome, StepOutcomes, TaskMode, observation,
};

/// A headless simulation and its scenario.
pub struct Lab {
    pub simulation: Simulation,
    pub scenario: Arc<Scenario>,
}

impl Lab {
    /// `arenas` arenas of `scenario` with the paper's reward and [`TaskMode::Continuing`].
    pub fn new(scenario: &Scenario, arenas: usize, seed: u64) -> Self {
        Self::with(scenario, arenas, seed, RewardConfig::default(), TaskMode::Continuing)
    }

    pub fn with(scenario: &Scenario, arenas: usize, seed: u64, reward: RewardConfig, mode: TaskMode) -> Self {
        let scenario = Arc::new(scenario.clone());
        let builder = SimulationBuilder::new(&scenario).arenas(arenas).seed(seed).reward(reward).mode(mode);
        Self { simulation: builder.build(), scenario }
    }

    /// Replaces the scenario and all arenas.
    pub fn spawn_arenas(&mut self, scenario: &Scenario, arenas: usize, seed: u64) {
        self.scenario = Arc::new(scenario.clone());
        sim::spawn_arenas(self.simulation.world_mut(), &self.scenario, arenas, seed);
    }

    /// Runs one control step; arena k takes `actions[k]`.
    pub fn step(&mut self, actions: &[usize]) {
        self.simulation.world_mut().resource_mut::<Actions>().0.copy_from_slice(actions);
        self.simulation.world_mut().run_schedule(ControlStep);
    }

    /// The episodes that have ended since the last call.
    pub fn take_ended_episodes(&mut self) -> Vec<EpisodeEnded> {
        self.simulation.world_mut().resource_mut::<Messages<EpisodeEnded>>().drain().collect()
    }

    /// The states of all arenas, in the order of their numbers.
    pub fn states(&mut self) -> Vec<ArenaState> {
        sim::snapshot(self.simulation.world_mut())
    }

    pub fn state(&mut self, arena: usize) -> ArenaState {
        self.states().swap_remove(arena)
    }

    /// Changes the state of one arena, for example the position of its robot or goal.
    pub fn edit(&mut self, arena: usize, edit: impl FnOnce(&mut ArenaState)) {
        let mut states = self.states();
        edit(&mut states[arena]);
        sim::restore(self.simulation.world_mut(), &states);
    }

    pub fn outcomes(&self) -> &[StepOutcome] {
        &self.simulation.world().resource::<StepOutcomes>().0
    }

    /// The current observation of `arena`.
    pub fn row(&self, arena: usize) -> Vec<f32> {
        self.simulation.world().resource::<Observations>().row(arena).to_vec()
    }

    /// The ranges of a new scan from `pose` in `arena`, in m, without noise.
    pub fn cast(&mut self, arena: usize, pose: &Pose) -> Vec<f32> {
        let beams = self.scenario.lidar.beam_directions();
        let max_range_m = self.scenario.lidar.max_range_m;
        self.with_physics(arena, |bodies, _, colliders| {
            let mut ranges_m = Vec::new();
            lidar::cast_in_arena(&colliders.colliders, bodies, pose, &beams, max_range_m, &mut ranges_m);
            ranges_m
        })
    }

    /// The result of `query` on rapier's bodies and colliders of `arena`.
    pub fn with_physics<T>(
        &mut self,
        arena: usize,
        query: impl FnOnce(&Bodies, &RapierRigidBodySet, &RapierContextColliders) -> T,
    ) -> T {
        let world = self.simulation.world_mut();
        let mut arenas = world.query::<(&Arena, &Bodies, &RapierRigidBodySet, &RapierContextColliders)>();
        let (_, bodies, set, colliders) =
            arenas.iter(world).find(|(number, ..)| number.0 == arena).expect("the arena exists");
        query(bodies, set, colliders)
    }

    /// Asserts that every arena's observation is eq. (8) of its current scan, pose and goal.
    pub fn assert_observations_current(&mut self, when: &str) {
        let layout = self.simulation.world().resource::<ObservationLayout>().clone();
        for (arena, state) in self.states().iter().enumerate() {
            let mut expected = vec![f32::NAN; layout.width(state.scan.ranges_m.len())];
            let readings = SensorReadings::default();
            observation::encode(
                layout.encoding,
                &ScanMemory::default(),
                &state.scan,
                (&state.pose, &state.goal),
                &readings,
                &mut expected,
            );
            assert_eq!(
                bits(&self.row(arena)),
                bits(&expected),
                "{when}, arena {arena}: the observation is eq. (8) of the current scan, pose and goal"
            );
        }
    }
}

pub fn bits(numbers: &[f32]) -> Vec<u32> {
    numbers.iter().map(|x| x.to_bits()).collect()
}

/// One random stream of actions per arena.
pub fn action_streams(arenas: usize) -> Vec<Stream> {
    (0..arenas as u64).map(|k| random::stream(99, "actions", k)).collect()
}

pub fn random_actions(action_streams: &mut [Stream]) -> Vec<usize> {
    action_streams.iter_mut().map(|stream| random::uniform_index(stream, 5)).collect()
}

/// Actions that turn towards the goal. A quarter of them are random, so that some robots collide.
pub fn steer_to_goal(lab: &Lab, action_streams: &mut [Stream]) -> Vec<usize> {
    let beams = lab.scenario.lidar.beams;
    let action = |(arena, stream): (usize, &mut Stream)| {
        let draw = random::uniform_index(stream, 20);
        let bearing_rad = lab.row(arena)[beams] * PI;
        match bearing_rad {
            _ if draw < 5 => draw,
            b if b > 0.3 => 0,
            b if b > 0.1 => 1,
            b if b > -0.1 => 2,
            b if b > -0.3 => 3,
            _ => 4,
        }
    };
    action_streams.iter_mut().enumerate().map(action).collect()
}

pub fn static_obstacle(shape: Shape, position_m: Vec2, rotation_rad: f32) -> Obstacle {
    Obstacle { shape, position_m, rotation_rad, motion: ObstacleMotion::Static }
}

/// Four static cylinders, as in the paper's Scenario I.
pub fn four_cylinders() -> Scenario {
    let at = [vec2(0.6, 0.6), vec2(-0.6, 0.6), vec2(-0.6, -0.6), vec2(0.6, -0.6)];
    let obstacles =
        at.map(|position_m| static_obstacle(Shape::Circle { radius_m: 0.15 }, position_m, 0.0)).into();
    Scenario { name: "Four cylinders".into(), obstacles, ..Scenario::default() }
}

/// Two cylinders and a rotated box on orbits, a box on patrol, and a static rotated box.
pub fn moving_obstacles() -> Scenario {
    let orbit = |speed_rad_s: f32| ObstacleMotion::Orbit {
        centre_m: vec2(0.0, 0.0),
        speed_rad_s: speed_rad_s.into(),
    };
    let cylinder = |position_m| Obstacle {
        motion: orbit(0.1),
        ..static_obstacle(Shape::Circle { radius_m: 0.15 }, position_m, 0.0)
    };
    let slab = Shape::Rectangle { width_m: 0.3, height_m: 0.15 };
    let patrol =
        ObstacleMotion::Patrol { waypoints_m: vec![vec2(1.4, -1.5), vec2(0.9, -1.2)], speed_m_s: 0.1.into() };
    Scenario {
        name: "Moving".into(),
        obstacles: vec![
            cylinder(vec2(0.6, 0.6)),
            cylinder(vec2(-0.6, -0.6)),
            Obstacle { motion: orbit(0.1), ..static_obstacle(slab.clone(), vec2(-0.7, 0.6), 0.4) },
            Obstacle { motion: patrol, ..static_obstacle(slab.clone(), vec2(-1.4, -1.5), 0.2) },
            static_obstacle(slab, vec2(0.0, 0.0), 0.7),
        ],
        ..Scenario::default()
    }
}

/// The moving obstacles with two pedestrians among them, of whom one sees the robot, and a generated obstacle.
pub fn pedestrians() -> Scenario {
    let walker = |position_m, goals_m: Vec<_>, sees_robot| {
        let motion = ObstacleMotion::Pedestrian { goals_m, speed_m_s: 0.2.into(), loops: true, sees_robot };
        Obstacle { motion, ..static_obstacle(Shape::Circle { radius_m: 0.1 }, position_m, 0.0) }
    };
    let shape = RandomShape::Circle { radius_m: (0.1, 0.1) };
    let mut scenario = moving_obstacles();
    scenario.name = "Pedestrians".into();
    scenario.obstacles.insert(1, walker(vec2(-1.6, 1.6), vec![vec2(1.6, 1.6), vec2(0.0, 1.0)], true));
    scenario.obstacles.push(walker(vec2(1.6, 1.5), vec![vec2(-1.6, 1.6)], false));
    scenario.generators = vec![Generator { count: 1, shape, gap_m: 0.3, within: None }];
    scenario
}

/// An empty arena of 200 m, with its walls beyond the LIDAR's range.
pub fn wide_open() -> Scenario {
    Scenario {
        enclosure: wayfield::scenario::Enclosure::Rectangle { width_m: 200.0, height_m: 200.0 },
        ..Scenario::default()
    }
}
