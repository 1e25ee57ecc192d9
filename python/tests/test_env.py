"""Tests of the environments."""

import copy
import math
import os
import pickle
import sys
import threading
import time

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode

import wayfield

ENV = "wayfield/Navigation-v0"
SETS = ["clutter", '(name: "Two", scenarios: [(scenario: "empty"), (scenario: "slalom")])']
SMALL = '(name: "small", enclosure: Rectangle(width_m: 2.0, height_m: 2.0), task: (max_episode_steps: 30))'


def rollout(envs, steps, seed=7):
    """The observations, rewards, terminated and truncated flags after random actions, an array of each."""
    rng = np.random.default_rng(seed)
    kept = [envs.reset(seed=seed)[0]], [], [], []
    for _ in range(steps):
        observations, rewards, terminated, truncated, _ = envs.step(rng.integers(0, 5, envs.num_envs))
        for values, value in zip(kept, (observations, rewards, terminated, truncated), strict=True):
            values.append(value)
    return [np.array(values) for values in kept]


# Continuous actions are in m/s and rad/s on purpose, not from -1 to 1.
# Observations by sectors have no bounds.
@pytest.mark.filterwarnings("error::UserWarning", "ignore:.*symmetric and normalized space", "ignore:.*infinity")
@pytest.mark.parametrize("actions", ["discrete", "continuous"])
@pytest.mark.parametrize(
    "options", [{}, {"scenario": "crowd", "task": "continuing"}, {"observation": "raw"}, {"preset": "general"}]
)
def test_gymnasiums_checker_accepts_the_environment(actions, options):
    check_env(gymnasium.make(ENV, actions=actions, **options).unwrapped)


@pytest.mark.parametrize("scenario", [*wayfield.scenarios(), *SETS])
@pytest.mark.parametrize("observation", ["scaled", "raw"])
def test_observations_lie_in_their_space_in_every_scenario(scenario, observation):
    envs = gymnasium.make_vec(ENV, num_envs=8, scenario=scenario, observation=observation)
    observations, *_ = rollout(envs, 60)
    space = envs.single_observation_space
    assert (observations >= space.low).all() and (observations <= space.high).all()


def test_a_scenario_is_a_name_a_path_or_a_text(tmp_path):
    path = tmp_path / "small.ron"
    path.write_text(SMALL)
    by_path = rollout(gymnasium.make_vec(ENV, num_envs=2, scenario=path), 50)
    by_text = rollout(gymnasium.make_vec(ENV, num_envs=2, scenario=SMALL), 50)
    assert all((a == b).all() for a, b in zip(by_path, by_text, strict=True))
    assert by_text[3].any(), "its time limit is 30 steps"
    copy = tmp_path / "small (1).ron"
    copy.write_text(SMALL)
    by_copy = rollout(gymnasium.make_vec(ENV, num_envs=2, scenario=copy), 50)
    assert all((a == b).all() for a, b in zip(by_copy, by_text, strict=True)), "a path may have parentheses"


def test_each_environment_draws_a_scenario_of_a_set(tmp_path):
    path = tmp_path / "set.ron"
    path.write_text('(name: "Two", scenarios: [(scenario: "scenario-1"), (scenario: "empty")])')
    once, again, one = (
        rollout(gymnasium.make_vec(ENV, num_envs=8, scenario=scenario), 200)
        for scenario in (path, path, "scenario-1")
    )
    assert all((a == b).all() for a, b in zip(once, again, strict=True))
    same = [(once[0][0, env] == one[0][0, env]).all() for env in range(8)]
    assert any(same), "some environments begin in the first scenario"
    assert not all(same), "some begin in the second"
    wayfield.draw(path, tmp_path / "set.svg")
    assert "Two" in (tmp_path / "set.svg").read_text()
    with pytest.raises(ValueError, match="is a set of scenarios"):
        wayfield.draw(path, tmp_path / "set.svg", plain=True)


def test_environment_k_is_the_same_for_any_number_of_environments():
    def drive(count):
        envs = gymnasium.make_vec(ENV, num_envs=count, scenario="crossing")
        first, _ = envs.reset(seed=7)
        return np.array([first, *(envs.step(np.full(count, 2))[0] for _ in range(60))])

    many, few = drive(9), drive(3)
    assert (many[:, :3] == few).all()
    one, _ = gymnasium.make(ENV, scenario="crossing").reset(seed=7)
    assert (one == many[0, 0]).all()


@pytest.mark.parametrize("task", ["navigation", "continuing"])
def test_all_autoreset_modes_have_the_same_episodes(task):
    options = {"num_envs": 1, "scenario": SMALL, "task": task}
    same = gymnasium.make_vec(ENV, autoreset_mode=AutoresetMode.SAME_STEP, **options)
    late = gymnasium.make_vec(ENV, autoreset_mode=AutoresetMode.NEXT_STEP, **options)
    off = gymnasium.make_vec(ENV, autoreset_mode=AutoresetMode.DISABLED, **options)
    for envs in (same, late, off):
        envs.reset(seed=3)
    rng = np.random.default_rng(1)
    ends = 0
    for _ in range(400):
        action = rng.integers(0, 5, 1)
        results = [envs.step(action) for envs in (same, late, off)]
        assert len({(r[1][0], r[2][0], r[3][0]) for r in results}) == 1, "rewards and ends"
        assert all(result[4]["_is_success"][0] for result in results[1:])
        if not (results[0][2] | results[0][3]).any():
            assert all((result[0] == results[0][0]).all() for result in results)
            continue
        ends += 1
        final = results[0][4]["final_obs"][0]
        assert (final == results[1][0][0]).all() and (final == results[2][0][0]).all()
        assert results[0][4]["final_info"]["_is_success"].all() and not results[0][4]["_is_success"].any()
        first, reward, terminated, truncated, info = late.step(rng.integers(0, 5, 1))
        assert (reward[0], terminated[0], truncated[0], info["_is_success"][0]) == (0.0, False, False, False)
        assert (first == results[0][0]).all()
        assert (off.reset(options={"reset_mask": np.array([True])})[0] == first).all()
    assert ends > 8


def test_a_masked_reset_leaves_the_other_environments_alone():
    envs = gymnasium.make_vec(ENV, num_envs=3, scenario=SMALL, autoreset_mode="Disabled")
    before, _ = envs.reset(seed=1)
    after, _ = envs.reset(options={"reset_mask": np.array([False, True, False])})
    assert (after[[0, 2]] == before[[0, 2]]).all() and (after[1] != before[1]).any()


def test_an_ended_environment_must_be_reset_if_autoreset_is_off():
    envs = gymnasium.make_vec(ENV, num_envs=1, scenario=SMALL, autoreset_mode=AutoresetMode.DISABLED)
    envs.reset(seed=1)
    with pytest.raises(RuntimeError, match="episode of environment 0 has ended; help: reset it"):
        for _ in range(100):
            envs.step([2])


def test_in_the_continuing_task_the_robot_drives_on_from_its_goal():
    envs = gymnasium.make_vec(ENV, num_envs=32, scenario=SMALL, task="continuing", autoreset_mode="SameStep")
    envs.reset(seed=5)
    goals = [envs.state(k)["goal"] for k in range(32)]
    rng, reached = np.random.default_rng(2), 0
    for _ in range(300):
        _, _, terminated, truncated, info = envs.step(rng.integers(0, 5, 32))
        for k in np.flatnonzero(terminated | truncated):
            state = envs.state(k)
            if info["final_info"]["is_success"][k]:
                reached += 1
                assert state["episode_steps"] > 0, "the time limit is not restarted"
                assert math.dist(state["pose"][:2], goals[k]) < 0.201, "the robot is still within the radius of the old goal"
                assert state["goal"] != goals[k]
            goals[k] = state["goal"]
    assert reached > 0


def test_the_reward_is_the_sum_of_its_named_terms():
    envs = gymnasium.make_vec(ENV, num_envs=16, scenario="scenario-1", autoreset_mode=AutoresetMode.DISABLED)
    envs.reset(seed=2)
    terms = ["reward_goal", "reward_collision", "reward_attraction", "reward_repulsion"]
    _, rewards, _, _, info = envs.step(np.full(16, 2))
    assert np.allclose(sum(info[term] for term in terms), rewards, atol=1e-4)
    assert (info["reward_attraction"] != 0).any()


def test_the_reward_can_be_changed_by_preset_and_by_field():
    def reward(**options):
        env = gymnasium.make(ENV, scenario=SMALL, **options)
        env.reset(seed=1)
        return sum(env.step(2)[1] for _ in range(3))

    assert reward(set={"reward.kind": "Traditional"}) == 0.0
    assert reward(preset="per_d3qn") == reward()
    assert reward(preset="(reward: (mu: 50.0, sigma: 50.0))") == pytest.approx(reward() / 2, rel=1e-4)
    with pytest.raises(FileNotFoundError, match="did you mean `fast`"):
        reward(preset="fsat")
    assert reward(set={"reward.mu": 50, "reward.sigma": 50.0}) == pytest.approx(reward() / 2, rel=1e-4)
    with pytest.raises(ValueError, match="reward.mew=1: unknown field `mew`.*the fields are"):
        reward(set={"reward.mew": 1})
    with pytest.raises(ValueError, match="reward.mu=-1: .*reward.mu.* is -1"):
        reward(set={"reward.mu": -1})


def test_the_scenario_can_be_changed_by_field():
    env = gymnasium.make(ENV, set={"scenario.lidar.beams": 12, "scenario.task.max_episode_steps": 12})
    assert env.observation_space.shape == (16,)
    env.reset(seed=1)
    assert [env.step(k % 2 * 4)[3] for k in range(12)] == [False] * 11 + [True]


def test_continuous_actions_command_speed_and_turning_rate():
    discrete, continuous = (gymnasium.make(ENV, scenario="scenario-1", actions=a) for a in ("discrete", "continuous"))
    assert continuous.action_space.low.tolist() == pytest.approx([0.0, -1.5])
    assert continuous.action_space.high.tolist() == pytest.approx([0.15, 1.5])
    motions = discrete.unwrapped.motions
    discrete.reset(seed=4), continuous.reset(seed=4)
    for action in (2, 0, 4, 1, 3):
        one, two = discrete.step(action), continuous.step(np.array(motions[action], np.float32))
        assert (one[0] == two[0]).all() and one[1:3] == two[1:3]
    pose = continuous.unwrapped.state["pose"]
    continuous.step(np.zeros(2, np.float32))
    assert continuous.unwrapped.state["pose"] == pose, "it stands still"
    with pytest.raises(ValueError, match="motion of environment 0 is not finite; help:"):
        continuous.step(np.array([np.nan, 0.0], np.float32))


def test_motions_are_read_row_by_row_in_any_memory_layout():
    motions = np.array([[0.1, 0.0], [0.05, 1.0], [0.15, -1.0]], np.float32)
    observations = []
    for given in (motions, np.asfortranarray(motions), np.repeat(motions, 2, axis=1)[:, ::2]):
        envs = gymnasium.make_vec(ENV, num_envs=3, scenario="empty", actions="continuous")
        envs.reset(seed=1)
        observations.append(envs.step(given)[0])
    assert all((observed == observations[0]).all() for observed in observations)


def test_rendered_images_show_the_robot():
    env = gymnasium.make(ENV, scenario="scenario-1", render_mode="rgb_array")
    env.reset(seed=1)
    first = env.render()
    assert first.shape == (720, 960, 3) and first.dtype == np.uint8
    env.step(2)
    second = env.render()
    changed = (first != second).any(axis=2).mean()
    assert 0 < changed < 0.2, "robot and beams moved, the rest did not"
    assert gymnasium.make(ENV).unwrapped.render() is None


def test_errors_are_python_exceptions_with_the_messages_of_the_command_line(tmp_path):
    with pytest.raises(FileNotFoundError, match="did you mean `scenario-1`"):
        gymnasium.make(ENV, scenario="scenaro-1")
    with pytest.raises(ValueError, match="has no levels; help:"):
        gymnasium.make(ENV, scenario="maze:17")
    with pytest.raises(IsADirectoryError, match="this is a folder"):
        gymnasium.make(ENV, scenario=tmp_path)
    latin = tmp_path / "latin.ron"
    latin.write_bytes(b'(name: "\xe9")')
    with pytest.raises(ValueError, match="not valid UTF-8"):
        gymnasium.make(ENV, scenario=latin)
    latin.chmod(0)
    if not os.access(latin, os.R_OK):
        with pytest.raises(PermissionError, match="can't be read"):
            gymnasium.make(ENV, scenario=latin)
    broken = tmp_path / "broken.ron"
    broken.write_text('(name: "x",\n lidar: (beams: 0))')
    with pytest.raises(ValueError, match=r"broken.ron:2:\d+: .*write a number from 1"):
        gymnasium.make(ENV, scenario=broken)
    for options in ({"task": "x"}, {"observation": "x"}, {"actions": "x"}, {"render_mode": "ansi"}):
        with pytest.raises(ValueError, match="help: give"):
            wayfield.NavigationEnv(**options)
    for num_envs in (0, 5000):
        with pytest.raises(ValueError, match="num_envs is .*; help: give a number from 1 to 4096"):
            gymnasium.make_vec(ENV, num_envs=num_envs)
    obstacles = "(shape: Circle(radius_m: 0.1), position_m: (3.0, 3.0)), " * 250
    enclosure = "Rectangle(width_m: 8.0, height_m: 8.0)"
    (tmp_path / "many.ron").write_text(f'(name: "Many", enclosure: {enclosure}, obstacles: [{obstacles}])')
    pair = tmp_path / "pair.ron"
    pair.write_text('(name: "Pair", scenarios: [(scenario: "empty"), (scenario: "many.ron")])')
    with pytest.raises(ValueError, match="num_envs=4096: .* bodies, more than"):
        gymnasium.make_vec(ENV, num_envs=4096, scenario=pair)
    envs = gymnasium.make_vec(ENV, num_envs=2)
    with pytest.raises(RuntimeError, match="help: call reset"):
        envs.step([0, 0])
    envs.reset(seed=1)
    for mask in (np.array([1, 0]), np.array([True]), "x"):
        with pytest.raises(ValueError, match=r"reset_mask is .*; help: give a bool array of the shape \(2,\)"):
            envs.reset(options={"reset_mask": mask})
    for actions, text in (([0], "shape"), ([0, 5], "out of range"), ([0, -1], "out of range")):
        with pytest.raises(ValueError, match=text):
            envs.step(actions)


def test_other_threads_run_during_a_step():
    envs = gymnasium.make_vec(ENV, num_envs=2048, scenario="hall")
    envs.reset(seed=1)
    turns, stop = [0], threading.Event()

    def count():
        while not stop.is_set():
            turns[0] += 1

    thread = threading.Thread(target=count)
    thread.start()
    interval_s = sys.getswitchinterval()
    # Longer than the step, so that the other thread runs during the step only if the step releases the GIL.
    sys.setswitchinterval(0.5)
    try:
        # The other thread may still be waiting for the old interval; this lets that wait end.
        time.sleep(0.01)
        before = turns[0]
        envs.step(np.zeros(2048, np.int64))
        during = turns[0] - before
    finally:
        stop.set()
        sys.setswitchinterval(interval_s)
        thread.join()
    assert during > 1000, f"{during} turns of the other thread"


def test_gymnasiums_wrappers_work():
    envs = gymnasium.make_vec(ENV, num_envs=4, scenario=SMALL)
    envs = gymnasium.wrappers.vector.RecordEpisodeStatistics(envs)
    envs = gymnasium.wrappers.vector.NormalizeObservation(envs)
    envs = gymnasium.wrappers.vector.DictInfoToList(envs)
    envs.reset(seed=1)
    episodes = [info["episode"] for _ in range(40) for info in envs.step([2] * 4)[4] if "episode" in info]
    assert episodes and all(episode["l"] <= 30 for episode in episodes)


@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
def test_an_info_read_later_is_that_of_its_own_step(mode):
    envs = gymnasium.make_vec(ENV, num_envs=32, autoreset_mode=mode)
    envs.reset(seed=5)
    rng, kept = np.random.default_rng(1), []
    for _ in range(80):
        _, rewards, terminated, truncated, info = envs.step(rng.integers(0, 5, 32))
        kept.append((rewards, terminated | truncated, info))
    ends = 0
    for rewards, done, info in kept:
        last = info["final_info"] if "final_info" in info else info
        terms = [np.where(done, last[name], info[name]) for name in info if name.startswith("reward_")]
        np.testing.assert_allclose(sum(terms), rewards, rtol=1e-6, atol=1e-4)
        ends += done.sum()
    assert ends > 10


@pytest.mark.parametrize(
    "read",
    [dict, lambda info: {**info}, lambda info: info | {}, lambda info: {} | info, lambda info: dict(info.items()), copy.copy]
    + [copy.deepcopy, lambda info: info.copy(), lambda info: pickle.loads(pickle.dumps(info)), lambda info: dict(**info)],
)
def test_an_info_is_a_dict_in_every_way_of_reading_it(read):
    envs = gymnasium.make_vec(ENV, num_envs=4)
    envs.reset(seed=5)
    *_, info = envs.step(np.zeros(4, int))
    contents = read(info)
    assert isinstance(info, dict) and len(contents) == 12 and contents["_collision"].all()
    assert list(contents) == list(info) and all((contents[key] == info[key]).all() for key in info)
