"""The slow check with Stable-Baselines3, which CI leaves out because torch is a download of gigabytes. ``.ci/sb3`` runs it, or:

    pip install ./python stable-baselines3 pytest
    python -m pytest python/tests/sb3_check.py
"""

import numpy as np
import pytest

pytest.importorskip("stable_baselines3")

from stable_baselines3 import DQN, PPO, SAC  # noqa: E402
from stable_baselines3.common.env_checker import check_env  # noqa: E402
from stable_baselines3.common.evaluation import evaluate_policy  # noqa: E402
from stable_baselines3.common.vec_env import VecMonitor, VecNormalize  # noqa: E402

import wayfield  # noqa: E402
from wayfield.sb3 import NavigationVecEnv  # noqa: E402


@pytest.mark.filterwarnings("error::UserWarning", "ignore:.*symmetric and normalized")
@pytest.mark.parametrize("actions", ["discrete", "continuous"])
def test_sb3s_checker_accepts_the_environment(actions):
    check_env(wayfield.NavigationEnv(actions=actions))


@pytest.mark.parametrize(("learner", "actions"), [(DQN, "discrete"), (PPO, "discrete"), (SAC, "continuous")])
def test_sb3s_learners_run(learner, actions):
    envs = VecMonitor(NavigationVecEnv(8, "scenario-1", task="continuing", actions=actions))
    model = learner("MlpPolicy", envs, seed=1).learn(3_000)
    assert model.ep_info_buffer, "episodes were counted"
    envs.close()


def test_terminal_observations_and_infos_follow_sb3():
    envs = NavigationVecEnv(16, "scenario-1")
    envs.seed(3)
    envs.reset()
    rng, ends = np.random.default_rng(1), 0
    for _ in range(600):
        observations, rewards, dones, infos = envs.step(rng.integers(0, 5, 16))
        for index in np.flatnonzero(dones):
            ends += 1
            assert (infos[index]["terminal_observation"] != observations[index]).any()
            assert isinstance(infos[index]["TimeLimit.truncated"], bool)
        assert all("terminal_observation" not in info for info, done in zip(infos, dones, strict=True) if not done)
    assert ends > 50
    VecNormalize(envs).reset()


def test_sb3_evaluates_a_policy_of_wayfield():
    policy = wayfield.Policy.load("scenario-1")
    envs = VecMonitor(NavigationVecEnv(16, "scenario-1"))
    returns, lengths = evaluate_policy(policy, envs, n_eval_episodes=50, return_episode_rewards=True)
    assert np.mean(np.array(returns) > 200) > 0.9 and max(lengths) <= 500
