"""Env steps per second: wayfield from Python against its native rate, and against the same task in numpy and in ir-sim.

    taskset -c 1 python python/benches/throughput.py

All rates are per CPU second, measured in turn on one core, in several rounds; the table has the medians. "numpy, 64 robots" is a
batched port of Scenario I without physics: kinematics, exact ray casting of 24 beams against four circles and four walls, the
reward, and resets. "numpy, one robot" is the same port with one robot as a gymnasium.Env. All environments with one robot are
wrapped in Gymnasium's RecordEpisodeStatistics, which collects the same statistics as SB3's Monitor. "ir-sim, one robot" is
Scenario I in ir-sim (irsim_env.py), if ir-sim is installed. Each ratio compares two rates of the same round; the table has the
median over the rounds. The overhead of a call is a hundredth of the median difference between the times of 100 steps from Python
and of the 100 native steps before them.
"""

import argparse
import importlib.util
import statistics
import time
from collections.abc import Callable

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode

import wayfield
from wayfield import _native

ENV = "wayfield/Navigation-v0"
MOTIONS = np.array([(0.15, 1.5), (0.15, 0.75), (0.15, 0.0), (0.15, -0.75), (0.15, -1.5)])
MODES = {
    AutoresetMode.NEXT_STEP: "",
    AutoresetMode.SAME_STEP: ", same-step autoreset",
    AutoresetMode.DISABLED: ", autoreset by the caller",
}
PERIOD_S, BEAMS, MAX_RANGE_M, MAX_STEPS = 0.2, 24, 3.5, 500
GOAL_RADIUS_M, COLLISION_RANGE_M, REPULSION_RANGE_M = 0.2, 0.13, 0.3


class NumpyTask:
    """Scenario I in numpy: ``n`` robots at once, without a physics engine. A robot is a point with 24 beams.

    The obstacles are circles with ``centres`` (circles, 2) and ``radius``; the enclosure is a square whose half side is ``half``.
    All are in m.
    """

    def __init__(self, n: int, centres: np.ndarray, radius: float, half: float) -> None:
        self.n, self.centres, self.radius, self.half = n, centres, radius, half
        self.rng = np.random.default_rng(0)
        self.angles = np.arange(BEAMS) * (2 * np.pi / BEAMS)
        self.x, self.y, self.heading, self.goal_x, self.goal_y = np.zeros((5, n))
        self.steps = np.zeros(n, np.int64)
        self.reset(np.arange(n))

    def reset(self, which: np.ndarray) -> None:
        """Draws new starts, headings and goals for the robots ``which`` (indices), away from the obstacles."""
        for k in which:
            positions = []
            while len(positions) < 2:
                position = self.rng.uniform(-self.half + 0.3, self.half - 0.3, 2)
                if (np.hypot(*(self.centres - position).T) > self.radius + 0.3).all():
                    positions.append(position)
            (self.x[k], self.y[k]), (self.goal_x[k], self.goal_y[k]) = positions
            self.heading[k] = self.rng.uniform(-np.pi, np.pi)
            self.steps[k] = 0
        self.scan()
        self.potential = self.compute_potential()

    def scan(self) -> None:
        """Casts the beams against circles and walls."""
        angles = self.heading[:, None] + self.angles
        cos, sin = np.cos(angles), np.sin(angles)
        with np.errstate(divide="ignore"):
            to_x = (np.copysign(self.half, cos) - self.x[:, None]) / cos
            to_y = (np.copysign(self.half, sin) - self.y[:, None]) / sin
        ranges = np.minimum(np.minimum(to_x, to_y), MAX_RANGE_M)
        dx = self.centres[:, 0] - self.x[:, None]
        dy = self.centres[:, 1] - self.y[:, None]
        along = cos[:, :, None] * dx[:, None] + sin[:, :, None] * dy[:, None]
        discriminant = self.radius**2 - (dx**2 + dy**2)[:, None] + along**2
        hits = along - np.sqrt(np.maximum(discriminant, 0.0))
        hits = np.where((discriminant > 0.0) & (hits > 0.0), hits, MAX_RANGE_M)
        self.ranges = np.minimum(ranges, hits.min(axis=2))
        self.nearest = self.ranges.min(axis=1)

    def compute_potential(self) -> np.ndarray:
        self.distance = np.hypot(self.goal_x - self.x, self.goal_y - self.y)
        repulsion = np.maximum(1.0 - self.nearest / REPULSION_RANGE_M, 0.0) ** 2
        return 50.0 * self.distance**2 + 50.0 * repulsion

    def observations(self) -> np.ndarray:
        row = np.empty((self.n, BEAMS + 4), np.float32)
        row[:, :BEAMS] = self.ranges / MAX_RANGE_M
        bearing = np.arctan2(self.goal_y - self.y, self.goal_x - self.x) - self.heading
        row[:, BEAMS] = (np.mod(bearing + np.pi, 2 * np.pi) - np.pi) / np.pi
        row[:, BEAMS + 1] = self.distance / 4.0
        row[:, BEAMS + 2] = self.nearest / MAX_RANGE_M
        row[:, BEAMS + 3] = self.ranges.argmin(axis=1) / BEAMS
        return row

    def advance(self, actions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Moves all robots by one control step. Returns rewards, terminated and truncated."""
        v, w = MOTIONS[actions].T
        middle = self.heading + 0.5 * w * PERIOD_S
        chord = v * PERIOD_S * np.sinc(0.5 * w * PERIOD_S / np.pi)
        self.x += chord * np.cos(middle)
        self.y += chord * np.sin(middle)
        self.heading += w * PERIOD_S
        self.steps += 1
        self.scan()
        before, self.potential = self.potential, self.compute_potential()
        collided = self.nearest < COLLISION_RANGE_M
        reached = ~collided & (self.distance < GOAL_RADIUS_M)
        rewards = np.where(collided, -200.0, np.where(reached, 250.0, before - self.potential))
        terminated, truncated = collided | reached, self.steps >= MAX_STEPS
        return rewards, terminated, truncated

    def step_with_autoreset(self, actions: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Steps all robots, and resets those whose episodes have ended."""
        rewards, terminated, truncated = self.advance(actions)
        ended = np.flatnonzero(terminated | truncated)
        if len(ended):
            self.reset(ended)
        return self.observations(), rewards, terminated, truncated


class NumpyEnv(gymnasium.Env):
    """One robot of the numpy port as a Gymnasium environment."""

    def __init__(self, *scene: object) -> None:
        self.task = NumpyTask(1, *scene)
        self.observation_space = gymnasium.spaces.Box(-1.0, 10.0, (BEAMS + 4,), np.float32)
        self.action_space = gymnasium.spaces.Discrete(len(MOTIONS))

    def reset(self, *, seed: int | None = None, options: dict | None = None) -> tuple[np.ndarray, dict]:
        super().reset(seed=seed)
        self.task.reset(np.arange(1))
        return self.task.observations()[0], {}

    def step(self, action: int) -> tuple[np.ndarray, float, bool, bool, dict]:
        rewards, terminated, truncated = self.task.advance(np.array([action]))
        return self.task.observations()[0], float(rewards[0]), bool(terminated[0]), bool(truncated[0]), {}


def rate_of(step, actions: np.ndarray, seconds: float) -> float:
    """Env steps per CPU second of ``step``, called with rows of ``actions``."""
    for row in actions[:200]:
        step(row)
    done, began = 0, time.process_time()
    while time.process_time() - began < seconds:
        for row in actions:
            step(row)
        done += actions.size
    return done / (time.process_time() - began)


def vector_step(envs: gymnasium.vector.VectorEnv) -> Callable[[np.ndarray], None]:
    """A function that steps ``envs`` and, if they are not reset automatically, resets those whose episodes have ended."""
    if envs.metadata["autoreset_mode"] is not AutoresetMode.DISABLED:
        return envs.step

    def step(row: np.ndarray) -> None:
        _, _, terminated, truncated, _ = envs.step(row)
        ended = terminated | truncated
        if ended.any():
            envs.reset(options={"reset_mask": ended})

    return step


def native_rate(envs: wayfield.NavigationVectorEnv, steps: int) -> float:
    """Env steps per CPU second of ``envs``, stepped without Python."""
    native = envs.unwrapped._native
    _native.benchmark(native, 200)
    began = time.process_time()
    _native.benchmark(native, steps)
    return envs.num_envs * steps / (time.process_time() - began)


def single_step(env: gymnasium.Env):
    """A function that steps ``env``, and resets it after each episode, as a training loop does."""
    env.reset(seed=1)

    def step(row: np.ndarray) -> None:
        *_, terminated, truncated, _ = env.step(int(row[0]))
        if terminated or truncated:
            env.reset()

    return step


def overhead_us(envs: wayfield.NavigationVectorEnv, actions: np.ndarray, blocks: int = 300) -> float:
    """How much longer a step of ``envs`` takes from Python than natively, in microseconds."""
    native, step = envs.unwrapped._native, vector_step(envs)
    differences = []
    for _ in range(blocks):
        times = [time.process_time()]
        _native.benchmark(native, len(actions))
        times.append(time.process_time())
        for row in actions:
            step(row)
        times.append(time.process_time())
        differences.append((times[2] - times[1]) - (times[1] - times[0]))
    return 1e6 * statistics.median(differences) / len(actions)


def measurements(seconds: float) -> dict[str, Callable[[], float]]:
    """What is measured, by name: functions that return env steps per CPU second."""
    centres = np.array([(0.6, 0.6), (-0.6, 0.6), (-0.6, -0.6), (0.6, -0.6)])
    rng = np.random.default_rng(1)
    many, one = rng.integers(0, 5, (1000, 64)), rng.integers(0, 5, (1000, 1))
    steps = round(5_000 * seconds)
    measured: dict[str, Callable[[], float]] = {}
    for mode, suffix in MODES.items():
        envs = gymnasium.make_vec(ENV, num_envs=64, autoreset_mode=mode)
        envs.reset(seed=1)
        measured[f"native, 64 robots{suffix}"] = lambda envs=envs: native_rate(envs, steps)
        measured[f"Python, 64 robots{suffix}"] = lambda step=vector_step(envs): rate_of(step, many, seconds)
    task = NumpyTask(64, centres, 0.15, 2.0)
    measured["numpy, 64 robots"] = lambda: rate_of(task.step_with_autoreset, many, seconds)
    robots = {"Python, one robot": wayfield.NavigationEnv(), "numpy, one robot": NumpyEnv(centres, 0.15, 2.0)}
    if importlib.util.find_spec("irsim"):
        from irsim_env import IrSimEnv

        robots["ir-sim, one robot"] = IrSimEnv(centres, 0.15, 2.0, MOTIONS)
    for name, robot in robots.items():
        step = single_step(gymnasium.wrappers.RecordEpisodeStatistics(robot))
        measured[name] = lambda step=step: rate_of(step, one, seconds)
    return measured


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--seconds", type=float, default=2.0, help="CPU seconds per measurement; a native one runs 5,000 steps per second given"
    )
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    measured = measurements(options.seconds)
    rounds = [{name: measure() for name, measure in measured.items()} for _ in range(options.rounds)]

    def median(value: Callable[[dict[str, float]], float]) -> float:
        return statistics.median(value(rates) for rates in rounds)

    print("| what | env steps per CPU second |\n|---|---:|")
    for name in measured:
        print(f"| {name} | {median(lambda rates, name=name: rates[name]):,.0f} |")
    print("\n| ratio | |\n|---|---:|")
    one = "Python, one robot"
    pairs = [
        *((f"Python, 64 robots{suffix}", f"native, 64 robots{suffix}") for suffix in MODES.values()),
        ("Python, 64 robots", "numpy, 64 robots"),
        *((one, other) for other in ("numpy, one robot", "ir-sim, one robot") if other in measured),
    ]
    for name, other in pairs:
        ratio = median(lambda rates, name=name, other=other: rates[name] / rates[other])
        print(f"| {name} : {other} | {ratio:.2f} |")
    actions = np.random.default_rng(1).integers(0, 5, (100, 64))
    for mode, suffix in MODES.items():
        envs = gymnasium.make_vec(ENV, num_envs=64, autoreset_mode=mode)
        envs.reset(seed=1)
        print(f"\nA vector call{suffix} takes {overhead_us(envs, actions):.1f} µs longer than a native step.")


if __name__ == "__main__":
    main()
