"""Tests of policies that drive robots outside wayfield, step by step."""

import json
import math

import numpy as np
import pytest

import wayfield

EMPTY = {"goal": (0.5, 2.0), "pose": (0.0, 0.0, 0.0), "twist": (0.0, 0.0)}


def evaluated(driver, scenario, folder, episodes=4):
    """The steps of an evaluation of `driver` in which it has chosen an action."""
    trace = folder / "steps.jsonl"
    wayfield.evaluate(driver, scenario, episodes=episodes, rounds=1, seed=3, trace=trace)
    steps = [json.loads(line) for line in trace.read_text().splitlines()]
    steps = [step for step in steps if step["action"] is not None]
    assert len(steps) > 50
    return steps


def percepts(steps, shift_m=(0.0, 0.0), turns=0):
    """The arguments of `Driver.act` in these steps, in a frame whose origin is shifted. `turns` full turns are added to the
    heading in every second step."""
    for index, step in enumerate(steps):
        x_m, y_m, heading_rad = (np.float32(step[name]) for name in ("x_m", "y_m", "heading_rad"))
        to_goal = np.float32(step["goal_x_m"]) - x_m, np.float32(step["goal_y_m"]) - y_m
        # Not wrapped to -pi..pi: any angle is allowed.
        bearing_rad = np.arctan2(to_goal[1], to_goal[0]) - heading_rad
        pose = (float(x_m) + shift_m[0], float(y_m) + shift_m[1], float(heading_rad) + index % 2 * turns * math.tau)
        goal = (float(bearing_rad), float(np.hypot(*to_goal)))
        yield step["step"], step["ranges_m"], {"goal": goal, "pose": pose, "twist": (step["v_m_s"], step["w_rad_s"])}


def driven(driver, steps, **frame):
    """The motions of `driver` for these steps."""
    motions = []
    for step, ranges_m, percept in percepts(steps, **frame):
        if step == 0:
            driver.reset()
        motions.append(driver.act(ranges_m, **percept))
    return motions


def actions(driver, steps, **frame):
    return np.array([motion.action for motion in driven(driver, steps, **frame)])


@pytest.mark.parametrize("scenario", ["scenario-1", "crossing"])
def test_a_policy_drives_as_in_its_evaluation(scenario, tmp_path):
    steps = evaluated("scenario-1", scenario, tmp_path)
    policy = wayfield.Policy.load("scenario-1")
    driver = policy.driver(scenario)
    motions = driven(driver, steps)
    assert [motion.action for motion in motions] == [step["action"] for step in steps]
    assert len({motion.action for motion in motions}) > 2
    for motion, (_, ranges_m, percept) in zip(motions, percepts(steps), strict=True):
        bearing_rad, distance_m = percept["goal"]
        row = policy.encode(ranges_m, math.remainder(bearing_rad, math.tau), distance_m)
        assert policy.act(row) == motion.action
        assert policy.velocities(row).tolist() == [motion.v_m_s, motion.w_rad_s]


@pytest.mark.parametrize("scenario", ["crossing", "u-trap"])
def test_a_policy_that_remembers_scans_drives_as_in_its_evaluation(scenario, tmp_path):
    steps = evaluated("general", scenario, tmp_path)
    driver = wayfield.Policy.load("general").driver(scenario)
    chosen = actions(driver, steps)
    assert np.mean(chosen == [step["action"] for step in steps]) > 0.99
    # Where they differ, rounding has decided between actions of almost equal value.
    for action, step in zip(chosen, steps, strict=True):
        assert step["q_values"][action] > step["q_values"][step["action"]] - 1e-2
    # The observation is the network's input, and almost all decisions are greedy.
    policy = wayfield.Policy.load("general")
    driver.reset()
    first = list(percepts(steps))[:100]
    greedy = [driver.act(ranges_m, **percept).action == policy.act(driver.observation) for _, ranges_m, percept in first]
    assert np.mean(greedy) > 0.9
    # The test shows something only if earlier scans matter.
    forgetful = []
    for _, ranges_m, percept in percepts(steps):
        driver.reset()
        forgetful.append(driver.act(ranges_m, **percept).action)
    assert np.mean(chosen == forgetful) < 0.99


@pytest.mark.parametrize(("name", "agreement"), [("scenario-1", 1.0), ("general", 0.99)])
def test_a_policy_with_a_map_drives_as_in_its_evaluation(name, agreement, tmp_path):
    steps = evaluated(f"{name}+map", "u-trap", tmp_path)
    policy = wayfield.Policy.load(name)
    theirs = np.array([step["action"] for step in steps])
    assert np.mean(actions(policy.driver("u-trap", with_map=True), steps) == theirs) >= agreement
    assert np.mean(actions(policy.driver("u-trap"), steps) == theirs) < 0.99, "the map matters"


def test_a_pose_may_be_in_any_frame(tmp_path):
    steps = evaluated("general", "crossing", tmp_path, episodes=2)
    driver = wayfield.Policy.load("general").driver("crossing", with_map=True)
    ours = actions(driver, steps)
    assert (ours == actions(driver, steps)).all(), "a reset forgets everything"
    moved = actions(driver, steps, shift_m=(-412_000.0, 5_311_000.0), turns=-1)
    assert np.mean(ours == moved) > 0.99


@pytest.mark.parametrize("name", ["general", "scenario-1"])
@pytest.mark.parametrize("with_map", [False, True])
@pytest.mark.parametrize("goal_m", [(2.0, 0.0), (-1.5, 1.0), (0.2, -2.0)])
def test_a_robot_in_the_open_turns_to_its_goal_and_reaches_it(name, with_map, goal_m):
    driver = wayfield.Policy.load(name).driver("scenario-1", with_map=with_map)
    ranges_m = [driver.max_range_m] * len(driver.beam_angles_rad)
    x_m, y_m, heading_rad, twist = 0.0, 0.0, 0.0, (0.0, 0.0)
    away_m, bearing_rad = [], []
    while not away_m or away_m[-1] > 0.2:
        dx_m, dy_m = goal_m[0] - x_m, goal_m[1] - y_m
        away_m.append(math.hypot(dx_m, dy_m))
        bearing_rad.append(math.remainder(math.atan2(dy_m, dx_m) - heading_rad, math.tau))
        goal = (bearing_rad[-1], away_m[-1])
        twist = driver.act(ranges_m, goal=goal, pose=(x_m, y_m, heading_rad), twist=twist)[:2]
        heading_rad += twist[1] * driver.control_period_s
        x_m += twist[0] * driver.control_period_s * math.cos(heading_rad)
        y_m += twist[0] * driver.control_period_s * math.sin(heading_rad)
        assert len(away_m) < 200, f"it is {away_m[-1]} m away after 40 s, three times as long as it takes"
    half = len(away_m) // 2
    assert np.mean(np.abs(bearing_rad[half:])) < 0.5, "it faces the goal"


def test_a_driver_knows_its_robot():
    driver = wayfield.Policy.load("general").driver("scenario-1", set={"scenario.lidar.beams": 360})
    angles_rad = driver.beam_angles_rad
    assert angles_rad.shape == (360,) and angles_rad[0] == 0 and np.isclose(np.diff(angles_rad), math.tau / 360, atol=1e-5).all()
    assert (driver.max_range_m, driver.control_period_s) == (3.5, 0.2)
    motion = driver.act([3.5] * 360, **EMPTY)
    assert motion == driver.act(np.full((360, 1), 12.0), **EMPTY), "a longer range counts as the maximum range"
    assert abs(motion.v_m_s) <= 0.16 and abs(motion.w_rad_s) <= 1.51


def test_a_policy_must_fit_the_scenario():
    policy = wayfield.Policy.load("scenario-1")
    with pytest.raises(ValueError, match="takes 28 numbers.*gives 16 numbers.*help: "):
        policy.driver("scenario-1", set={"scenario.lidar.beams": 12})
    with pytest.raises(FileNotFoundError, match="help: "):
        policy.driver("scenario-0")
    with pytest.raises(ValueError, match="did you mean `beams`"):
        policy.driver("scenario-1", set={"scenario.lidar.beems": 12})
    with pytest.warns(UserWarning, match="differs from what this policy was trained with"):
        policy.driver("scenario-1", set={"scenario.task.control_period_s": 0.1})
    with pytest.raises(ValueError, match=r"help: drive with policy\.driver\(scenario\)"):
        wayfield.Policy.load("general").encode([3.5] * 24, 0.0, 1.0)


@pytest.mark.parametrize(
    ("percept", "message"),
    [
        ({"ranges_m": [1.0] * 20}, "20 ranges, but the LIDAR of .* has 24 beams; help: give 24 ranges"),
        ({"ranges_m": []}, "0 ranges"),
        ({"ranges_m": [1.0] * 23 + [math.nan]}, "range 23 of the scan is NaN; help: .* maximum range, 3.5 m"),
        ({"ranges_m": [math.inf] + [1.0] * 23}, "range 0 of the scan is inf; help: "),
        ({"ranges_m": [1.0, -0.1] + [1.0] * 22}, "range 1 of the scan is -0.1; help: "),
        ({"goal": (math.nan, 1.0)}, "goal: bearing_rad is NaN; help: give a finite number"),
        ({"goal": (0.0, 1e300)}, "goal: distance_m is 1e300; help: give a finite number"),
        ({"goal": (0.0, -1.0)}, "goal: distance_m is -1.0; help: "),
        ({"pose": (0.0, math.inf, 0.0)}, "pose: y_m is inf; help: "),
        ({"twist": (0.0, -math.inf)}, "twist: w_rad_s is -inf; help: "),
    ],
)
def test_invalid_percepts_are_refused_and_forgotten(percept, message):
    driver, other = (wayfield.Policy.load("general").driver("scenario-1", with_map=True) for _ in range(2))
    right = {"ranges_m": [3.5] * 24, **EMPTY}
    for k in range(6):
        with pytest.raises(ValueError, match=message):
            driver.act(**{**right, **percept})
        right["ranges_m"] = [3.5 - 0.3 * k] * 24
        assert driver.act(**right) == other.act(**right)


def test_no_valid_percept_causes_an_internal_error():
    rng = np.random.default_rng(1)
    for name in ("general", "scenario-1"):
        driver = wayfield.Policy.load(name).driver("scenario-1", with_map=True)
        for _ in range(300):
            numbers = rng.choice([0.0, 1e-30, 1.0, -1.0, 3.0, 1e4, -1e7, 1e7], 7)
            ranges_m = rng.choice([0.0, 1e-30, 0.1, 3.499, 3.5, 1e30], 24)
            goal = (numbers[0], abs(numbers[1]))
            motion = driver.act(ranges_m, goal=goal, pose=tuple(numbers[2:5]), twist=tuple(numbers[5:]))
            assert math.isfinite(motion.v_m_s) and math.isfinite(motion.w_rad_s)
