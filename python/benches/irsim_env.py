"""Scenario I in ir-sim (``pip install ir-sim``), as a gymnasium.Env: the same enclosure, obstacles, motions, LIDAR and rewards.

The differences: the robot's radius is 0.105 m here and 0.1 m in wayfield; the first beam points backwards here and straight ahead
in wayfield; starts and goals are at least 0.3 m from walls and obstacles here and 0.35 m in wayfield; and a goal may be
arbitrarily close to the start here, but is at least 0.5 m away in wayfield.
"""

import tempfile

import gymnasium
import irsim
import numpy as np

MAX_RANGE_M, MAX_STEPS = 3.5, 500
GOAL_RADIUS_M, COLLISION_RANGE_M, REPULSION_RANGE_M = 0.2, 0.13, 0.3
# The last of 25 beams over a full circle is the first one again.
WORLD = """
world: {height: 4, width: 4, offset: [-2, -2], step_time: 0.2, sample_time: 0.2, collision_mode: stop}
robot:
  - kinematics: {name: diff}
    shape: {name: circle, radius: 0.105}
    state: [0, 0, 0]
    goal: [1.2, 1.2, 0]
    vel_max: [0.15, 1.5]
    sensors:
      - {name: lidar2d, range_min: 0, range_max: 3.5, angle_range: 6.2831853, number: 25}
obstacle:
  - number: 4
    distribution: {name: manual}
    shape: {name: circle, radius: 0.15}
    state: [[0.6, 0.6], [-0.6, 0.6], [-0.6, -0.6], [0.6, -0.6]]
  - shape: {name: linestring, vertices: [[-2, -2], [2, -2], [2, 2], [-2, 2], [-2, -2]]}
    state: [0, 0, 0]
"""


class IrSimEnv(gymnasium.Env):
    """One ir-sim robot."""

    def __init__(self, centres: np.ndarray, radius_m: float, half_m: float, motions: np.ndarray) -> None:
        self.centres, self.radius_m, self.half_m, self.motions = centres, radius_m, half_m, motions
        with tempfile.NamedTemporaryFile("w", suffix=".yaml") as file:
            file.write(WORLD)
            file.flush()
            self.sim = irsim.make(file.name, display=False, disable_all_plot=True, log_level="ERROR")
        self.observation_space = gymnasium.spaces.Box(-1.0, 10.0, (28,), np.float32)
        self.action_space = gymnasium.spaces.Discrete(len(motions))

    def reset(self, *, seed: int | None = None, options: dict | None = None) -> tuple[np.ndarray, dict]:
        super().reset(seed=seed)
        (x, y), self.goal = self.free_position(), self.free_position()
        self.steps = 0
        self.sim.reset()
        self.sim.robot.set_state([x, y, self.np_random.uniform(-np.pi, np.pi)])
        self.sim.step(np.zeros((2, 1)))
        self.sense()
        return self.observation(), {}

    def free_position(self) -> np.ndarray:
        """Draws a position at least 0.3 m from walls and obstacles."""
        while True:
            position = self.np_random.uniform(-self.half_m + 0.3, self.half_m - 0.3, 2)
            if (np.hypot(*(self.centres - position).T) > self.radius_m + 0.3).all():
                return position

    def sense(self) -> None:
        """Reads the scan and the pose, and computes the potential."""
        self.ranges = self.sim.get_lidar_scan()["ranges"][:24]
        self.x, self.y, self.heading = self.sim.robot.state[:3, 0]
        self.distance, self.nearest = np.hypot(*(self.goal - (self.x, self.y))), self.ranges.min()
        self.potential = 50 * self.distance**2 + 50 * max(1 - self.nearest / REPULSION_RANGE_M, 0) ** 2

    def observation(self) -> np.ndarray:
        bearing = np.arctan2(self.goal[1] - self.y, self.goal[0] - self.x) - self.heading
        bearing = (bearing + np.pi) % (2 * np.pi) - np.pi
        rest = (bearing / np.pi, self.distance / 4, self.nearest / MAX_RANGE_M, self.ranges.argmin() / 24)
        return np.concatenate((self.ranges / MAX_RANGE_M, rest)).astype(np.float32)

    def step(self, action: int) -> tuple[np.ndarray, float, bool, bool, dict]:
        self.sim.step(self.motions[action].reshape(2, 1))
        before, self.steps = self.potential, self.steps + 1
        self.sense()
        collided = bool(self.nearest < COLLISION_RANGE_M or self.sim.robot.collision)
        reached = bool(not collided and self.distance < GOAL_RADIUS_M)
        reward = -200.0 if collided else 250.0 if reached else float(before - self.potential)
        return self.observation(), reward, collided or reached, self.steps >= MAX_STEPS, {}
