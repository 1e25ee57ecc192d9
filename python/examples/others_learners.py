"""Learners of other libraries in wayfield's environments, and wayfield's own: success, env steps and CPU seconds in one table.

    pip install ./python stable-baselines3 tyro tensorboard
    git clone https://github.com/vwxyzjn/cleanrl
    python python/examples/others_learners.py --cleanrl cleanrl --out others

Each learner trains once per scenario, in the task ``continuing`` that wayfield's learner trains in, on one thread of torch.
CPU seconds are those of the whole training run, with all threads. Then its last policy drives the 500 episodes of
``wayfield --eval --seed 0``. A training run whose files are in the folder ``--out`` is not repeated.
"""

import argparse
import json
import shutil
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cleanrl_dqn
import numpy as np
import stable_baselines3
import torch
from stable_baselines3.common.base_class import BaseAlgorithm

import wayfield
from wayfield.sb3 import NavigationVecEnv

SEED = 1
SCENARIOS = ("scenario-1", "random-field")

# Observations in, actions out.
Act = Callable[[np.ndarray], Any]


@dataclass(frozen=True)
class Learner:
    """A learner: how to train with it, and how to load the policy. One row of the table per scenario."""

    name: str
    env_steps: int
    train: Callable[[str, int, Path], None]
    load: Callable[[Path], Act]
    actions: str = "discrete"


def wayfield_learner(name: str, env_steps: int) -> Learner:
    """wayfield's learner with the preset ``fast``."""

    def train(scenario: str, steps: int, path: Path) -> None:
        folder = path.with_suffix(".run")
        # An interrupted training run may have left its folder, and a run needs a new one.
        shutil.rmtree(folder, ignore_errors=True)
        result = wayfield.train(scenario, seed=SEED, steps=steps, out=folder, progress=False)
        result.last_policy.save(path)

    return Learner(name, env_steps, train, lambda path: wayfield.Policy.load(path).act)


def sb3_learner(
    name: str, algorithm: type[BaseAlgorithm], env_steps: int, envs: int = 1, scale: float = 1.0, **options: Any
) -> Learner:
    """A learner of Stable-Baselines3, with its defaults except for ``options``; ``scale`` multiplies the rewards."""
    actions = "continuous" if algorithm is stable_baselines3.SAC else "discrete"

    def train(scenario: str, steps: int, path: Path) -> None:
        env = NavigationVecEnv(envs, scenario, task="continuing", actions=actions, set=cleanrl_dqn.scaled_rewards(scale))
        algorithm("MlpPolicy", env, seed=SEED, device="cpu", **options).learn(steps).save(path)
        env.close()

    def load(path: Path) -> Act:
        model = algorithm.load(path, device="cpu")
        return lambda observations: model.predict(observations, deterministic=True)[0]

    return Learner(name, env_steps, train, load, actions)


def cleanrl_learner(name: str, script: Path, env_steps: int, scale: float = 1.0, **options: Any) -> Learner:
    """CleanRL's DQN, with its defaults except for ``options``; ``scale`` multiplies the rewards."""

    def train(scenario: str, steps: int, path: Path) -> None:
        torch.save(cleanrl_dqn.train(script, scenario, steps, SEED, scale, **options).state_dict(), path)

    def load(path: Path) -> Act:
        network = cleanrl_dqn.q_network(torch.load(path))
        return lambda observations: network(torch.from_numpy(observations)).argmax(dim=1).numpy()

    return Learner(name, env_steps, train, load)


# A single guess each, with wayfield's discount factor and reward scale; the values were not searched for.
TUNED_PPO: dict[str, Any] = {"envs": 16, "scale": 0.01, "gamma": 0.95, "n_steps": 128}
TUNED_DQN: dict[str, Any] = {
    "scale": 0.01,
    "gamma": 0.95,
    "learning_rate": 1e-3,
    "target_update_interval": 1000,
    "exploration_final_eps": 0.02,
}


def learners(cleanrl: Path | None) -> list[Learner]:
    """The learners of the table."""
    found = [
        wayfield_learner("wayfield, preset `fast`", 200_000),
        wayfield_learner("wayfield, preset `fast`, all of its steps", 600_000),
        sb3_learner("SB3 PPO, defaults", stable_baselines3.PPO, 200_000),
        sb3_learner("SB3 PPO, 16 robots, tuned", stable_baselines3.PPO, 200_000, **TUNED_PPO),
        sb3_learner("SB3 DQN, defaults", stable_baselines3.DQN, 200_000),
        sb3_learner("SB3 DQN, tuned", stable_baselines3.DQN, 200_000, **TUNED_DQN),
    ]
    if cleanrl is not None:
        found.append(cleanrl_learner("CleanRL DQN, defaults", cleanrl / "cleanrl/dqn.py", 200_000))
    return [*found, sb3_learner("SB3 SAC, defaults, continuous actions", stable_baselines3.SAC, 20_000)]


def row(learner: Learner, scenario: str, env_steps: int, out: Path) -> str:
    """Trains unless this was done before, evaluates, and returns a row of the table."""
    name = "".join(c if c.isalnum() else "-" for c in f"{scenario} {learner.name} {env_steps}".lower())
    path = (out / f"{name}.policy").absolute()
    record = path.with_suffix(".json")
    if not record.exists():
        began = time.process_time()
        learner.train(scenario, env_steps, path)
        record.write_text(json.dumps({"cpu_s": time.process_time() - began}))
    cpu_s = json.loads(record.read_text())["cpu_s"]
    result = wayfield.evaluate_function(learner.load(path), scenario, actions=learner.actions)
    low, high = (100 * bound for bound in result.success_interval)
    rates = f"{100 * result.success_rate:.1f} % ({low:.1f} to {high:.1f}) | {100 * result.collision_rate:.1f} %"
    return f"| {scenario} | {learner.name} | {rates} | {env_steps:,} | {cpu_s:,.0f} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cleanrl", type=Path, help="a clone of CleanRL; without it, CleanRL's rows are left out")
    parser.add_argument("--out", type=Path, default=Path("others"), help="the folder of the trained policies")
    parser.add_argument("--only", default="", help="only the learners whose names contain this text")
    parser.add_argument("--scenario", choices=SCENARIOS, help="only this scenario")
    parser.add_argument("--env-steps", type=int, help="the budget of each training run; otherwise the learner's own")
    options = parser.parse_args()
    torch.set_num_threads(1)
    options.out.mkdir(parents=True, exist_ok=True)
    versions = {"SB3": stable_baselines3.__version__, "torch": torch.__version__, "numpy": np.__version__}
    print(", ".join(f"{name} {version}" for name, version in versions.items()))
    print("| scenario | learner | success (95 %) | collisions | env steps | CPU seconds |\n|---|---|---:|---:|---:|---:|")
    for scenario in [options.scenario] if options.scenario else SCENARIOS:
        for learner in learners(options.cleanrl):
            if options.only in learner.name:
                env_steps = options.env_steps or learner.env_steps
                print(row(learner, scenario, env_steps, options.out), flush=True)


if __name__ == "__main__":
    sys.exit(main())
