"""Fast Gymnasium environments for LIDAR navigation, and a learner that solves them in seconds.

>>> import gymnasium as gym, wayfield
>>> env = gym.make("wayfield/Navigation-v0", scenario="scenario-1")
>>> envs = gym.make_vec("wayfield/Navigation-v0", num_envs=64, scenario="random-field")
>>> result = wayfield.train(scenario="scenario-1", seed=7)          # about ten seconds
>>> actions = result.policy.act(envs.reset(seed=1)[0])

Importing the package registers the environment ``wayfield/Navigation-v0``.
"""

from gymnasium.envs.registration import register

from . import _native
from .driver import Driver, Motion
from .env import NavigationEnv
from .evaluation import Evaluation, evaluate, evaluate_function
from .files import Problem, check, draw, presets, scenario_text, scenarios
from .importing import ImportedScenario, import_scenario
from .policy import Policy
from .suites import FamilyEvaluation, SuiteEvaluation
from .training import TrainingResult, load_run, resume, train
from .vector import NavigationVectorEnv

__version__ = _native.version()

__all__ = [
    "Driver",
    "Evaluation",
    "FamilyEvaluation",
    "ImportedScenario",
    "Motion",
    "NavigationEnv",
    "NavigationVectorEnv",
    "Policy",
    "Problem",
    "SuiteEvaluation",
    "TrainingResult",
    "check",
    "draw",
    "evaluate",
    "evaluate_function",
    "import_scenario",
    "load_run",
    "presets",
    "resume",
    "scenario_text",
    "scenarios",
    "train",
]

# The scenario sets the time limit, so Gymnasium's spec has no `max_episode_steps`.
register(
    id="wayfield/Navigation-v0",
    entry_point="wayfield.env:NavigationEnv",
    vector_entry_point="wayfield.vector:NavigationVectorEnv",
)
