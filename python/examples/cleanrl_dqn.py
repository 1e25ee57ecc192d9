"""CleanRL's DQN in wayfield's environments: runs its unchanged `cleanrl/dqn.py` with the ID of a wayfield environment.

    git clone https://github.com/vwxyzjn/cleanrl
    pip install ./python torch tyro tensorboard
    python python/examples/cleanrl_dqn.py cleanrl/cleanrl/dqn.py --scenario random-field

CleanRL's file is written for Gymnasium 0.29, where an environment is reset in the step that ends its episode. Gymnasium 1 resets
it one step later and returns the last observation under another key, so the file would fail at the first time limit. While
the file runs, ``gymnasium.vector.SyncVectorEnv`` therefore behaves as in 0.29 (``OldSyncVectorEnv``).
"""

import argparse
import runpy
import sys
from pathlib import Path
from typing import Any
from unittest import mock

import gymnasium
import numpy as np
import torch
from gymnasium.vector import AutoresetMode, SyncVectorEnv


class OldSyncVectorEnv(SyncVectorEnv):
    """``SyncVectorEnv`` with the autoreset behaviour and the info keys of Gymnasium 0.29."""

    def __init__(self, env_fns: Any) -> None:
        super().__init__(env_fns, autoreset_mode=AutoresetMode.SAME_STEP)

    def step(self, actions: Any) -> tuple[Any, ...]:
        *results, infos = super().step(actions)
        if "final_obs" in infos:
            infos["final_observation"] = infos.pop("final_obs")
            infos["final_info"] = [infos["final_info"] if ended else None for ended in infos["_final_obs"]]
        return *results, infos


def scaled_rewards(scale: float) -> dict[str, float]:
    """Settings that multiply the rewards of the preset ``fast``; none for a scale of 1."""
    rewards = {"reached": 250.0, "collided": -200.0, "mu": 100.0, "sigma": 100.0}
    return {} if scale == 1.0 else {f"reward.{name}": scale * value for name, value in rewards.items()}


def train(script: Path, scenario: str, env_steps: int, seed: int, scale: float = 1.0, **options: Any) -> torch.nn.Module:
    """Runs CleanRL's ``dqn.py`` in ``scenario``, on the same task as wayfield's learner.

    Args:
        script: The path of ``dqn.py``.
        scale: The factor of the rewards.
        options: Options of ``dqn.py``, such as ``gamma=0.95``.

    Returns:
        The trained Q-network.
    """
    name = f"wayfield/{scenario}-v0"
    settings = {"scenario": scenario, "task": "continuing", "set": scaled_rewards(scale)}
    gymnasium.register(name, entry_point="wayfield:NavigationEnv", kwargs=settings)
    options |= {"env_id": name, "total_timesteps": env_steps, "seed": seed}
    arguments = [text for key, value in options.items() for text in (f"--{key.replace('_', '-')}", str(value))]
    path = [str(script.resolve().parent.parent), *sys.path]
    with (
        mock.patch.object(sys, "argv", [str(script), *arguments]),
        mock.patch.object(sys, "path", path),
        mock.patch.object(gymnasium.vector, "SyncVectorEnv", OldSyncVectorEnv),
    ):
        network: torch.nn.Module = runpy.run_path(str(script), run_name="__main__")["q_network"]
    # CleanRL trains on a GPU if there is one.
    return network.cpu()


def q_network(weights: dict[str, torch.Tensor]) -> torch.nn.Module:
    """The Q-network of ``dqn.py`` with these weights."""
    shapes = [weight.shape for name, weight in weights.items() if name.endswith("weight")]
    layers: list[torch.nn.Module] = []
    for outputs, inputs in shapes:
        layers += [torch.nn.Linear(inputs, outputs), torch.nn.ReLU()]
    network = torch.nn.Sequential(*layers[:-1])
    network.load_state_dict({name.removeprefix("network."): weight for name, weight in weights.items()})
    return network


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("script", type=Path, help="CleanRL's cleanrl/dqn.py")
    parser.add_argument("--scenario", default="scenario-1")
    parser.add_argument("--env-steps", type=int, default=200_000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    import wayfield

    network = train(options.script, options.scenario, options.env_steps, options.seed)

    def act(observations: np.ndarray) -> np.ndarray:
        return network(torch.from_numpy(observations)).argmax(dim=1).numpy()

    print(f"success rate: {100 * wayfield.evaluate_function(act, options.scenario).success_rate:.1f} %")


if __name__ == "__main__":
    main()
