"""Tests of training, evaluation and policies."""

import ast
import importlib.util
import json
import operator
import os
import pickle
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import gymnasium
import numpy as np
import pytest

import wayfield
from wayfield import _frames, _native, _settings

STEPS = 20_000


def cli(*words):
    """What `wayfield ... --json` prints, as an object."""
    command = [sys.executable, "-m", "wayfield", *map(str, words), "--json"]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def policy_file(folder):
    wayfield.Policy.load("scenario-1").save(folder / "shipped.safetensors")
    return folder / "shipped.safetensors"


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return wayfield.train("scenario-1", seed=7, steps=STEPS, out=tmp_path_factory.mktemp("run") / "run", progress=False)


def test_a_suite_gives_the_results_of_the_command_line(tmp_path):
    suite = tmp_path / "suite.ron"
    suite.write_text('''(name: "S", families: [(name: "still", scenarios: ["scenario-1", "maze"], episodes: 3),
        (name: "levels", generator: "clutter", levels: 5)])''')
    field, policy = wayfield.evaluate(["field", wayfield.Policy.load("scenario-1")], suite=suite, seed=2)
    assert (field.suite, list(field.families), field.driver_class) == ("S", ["still", "levels"], "A")
    for name, ours in [("field", field), ("scenario-1", policy)]:
        theirs = cli("--eval", name, "--suite", suite, "--seed", 2)
        for family, result in theirs["families"].items():
            for key, value in result.items():
                found = getattr(ours.families[family], key)
                assert (list(found) if isinstance(found, tuple) else found) == value, (family, key)
    alone = wayfield.evaluate("field", suite=suite, seed=2, episodes=1, set={"scenario.task.max_episode_steps": 10})
    assert alone.families["levels"].timeout_rate == 1 and alone.families["still"].episodes == 2
    with pytest.raises(ValueError, match="can't be used with suite; help: "):
        wayfield.evaluate("field", suite=suite, rounds=2)
    with pytest.raises(ValueError, match="did you mean `maze`"):
        wayfield.evaluate("field", suite="mzae")


def test_training_gives_the_same_bits_as_the_command_line(run, tmp_path):
    summary = cli("--train", "--seed", 7, "--steps", STEPS, "--out", tmp_path / "run")
    assert (tmp_path / "run/policy.safetensors").read_bytes() == (run.folder / "policy.safetensors").read_bytes()
    assert summary["episodes"] == run.summary["episodes"]
    assert run.summary["env_steps"] == STEPS


def test_a_result_has_arrays_and_policies(run):
    assert len(run.episodes["return"]) == run.summary["episodes"] > 50
    assert run.evaluations["success_rate"].max() == run.summary["best_success_rate"]
    assert run._repr_svg_().startswith("<svg")
    assert run.policy.num_inputs == 28 and run.last_policy.num_actions == 5
    assert wayfield.load_run(run.folder).summary == run.summary


def test_a_run_over_a_set_names_the_scenario_of_each_episode(tmp_path):
    scenarios = '(name: "Two", scenarios: [(scenario: "scenario-1"), (scenario: "empty")])'
    result = wayfield.train(scenarios, seed=7, steps=10_000, out=tmp_path / "run", progress=False)
    assert set(result.episodes["scenario"]) == {"scenario-1", "empty"}
    assert np.isfinite(result.episodes["return"]).all()
    assert len(result.evaluations["success_rate_empty"]) == len(result.evaluations["success_rate"])


def test_frames_are_pandas_if_it_is_installed(run):
    if importlib.util.find_spec("pandas"):
        assert len(run.episodes_frame()) == run.summary["episodes"]
    else:
        with pytest.raises(ImportError, match="help: pip install pandas"):
            run.episodes_frame()


@pytest.mark.parametrize("scenario", [None, "scenario-2"])
def test_an_evaluation_has_the_results_of_the_command_line(run, scenario):
    path = run.folder / "policy.safetensors"
    options = [] if scenario is None else ["--scenario", scenario]
    printed = cli("--eval", path, "--seed", 3, "--episodes", 20, "--rounds", 2, *options)
    ours = wayfield.evaluate(path, scenario, seed=3, episodes=20, rounds=2)
    for key in ("success_rate", "collision_rate", "timeout_rate", "mean_time_s", "mean_cost_s", "rounds", "seed"):
        assert getattr(ours, key) == printed[key], key
    assert list(ours.success_interval) == printed["success_interval"]
    assert (ours.episodes["outcome"] == "success").mean() == ours.success_rate
    csv = run.folder.parent / f"{scenario}.csv"
    cli("--eval", path, "--seed", 3, "--episodes", 20, "--rounds", 2, "--csv", csv, *options)
    header, first = csv.read_text().splitlines()[:2]
    assert header.split(",")[1:] == list(ours.episodes)
    assert float(first.split(",")[header.split(",").index("goal_x_m")]) == pytest.approx(ours.episodes["goal_x_m"][0])


def test_the_columns_of_an_evaluation_keep_layout_seeds_exact_and_missing_strings_empty():
    seeds = [5, 2**64 - 1]
    columns = _frames.columns([{"layout_seed": seed, "hit": None, "hit_index": None} for seed in seeds])
    assert columns["layout_seed"].tolist() == seeds
    assert columns["hit"].tolist() == ["", ""]
    assert np.isnan(columns["hit_index"]).all()


@pytest.mark.parametrize("actions", ["discrete", "continuous"])
def test_a_function_drives_the_same_episodes_as_a_policy(actions):
    policy = wayfield.Policy.load("scenario-1")
    act = policy.act if actions == "discrete" else policy.velocities
    options = {"seed": 3, "episodes": 300, "rounds": 2}
    of_policy = wayfield.evaluate(policy, "scenario-1", **options)
    of_function = wayfield.evaluate_function(act, actions=actions, **options)
    assert of_policy.success_rate > 0.9 and of_function.rounds == of_policy.rounds and of_function.weights_crc32c is None
    for name, column in of_policy.episodes.items():
        np.testing.assert_array_equal(of_function.episodes[name], column, err_msg=name)


def test_a_function_that_is_evaluated_gets_clear_errors():
    def fail(observations):
        assert observations.shape == (10, 28) and observations.dtype == np.float32 and observations.flags.writeable
        raise KeyError("mine")

    options = {"episodes": 10, "rounds": 1}
    with pytest.raises(KeyError, match="mine"):
        wayfield.evaluate_function(fail, **options)
    with pytest.raises(ValueError, match=r"have the shape \(3,\); help: give an array of the shape \(10,\)"):
        wayfield.evaluate_function(lambda _: np.zeros(3), **options)
    for action in (5, -1):
        with pytest.raises(ValueError, match=f"action {action} of environment 0 is out of range"):
            wayfield.evaluate_function(lambda rows, action=action: np.full(len(rows), action), **options)
    with pytest.raises(ValueError, match="action 0.5 of environment 0 is not a whole number; help:"):
        wayfield.evaluate_function(lambda rows: np.full(len(rows), 0.5), **options)
    with pytest.raises(ValueError, match="motion of environment 0 is not finite"):
        wayfield.evaluate_function(lambda rows: np.full((len(rows), 2), np.nan), actions="continuous", **options)
    with pytest.raises(ValueError, match='help: give "discrete" or "continuous"'):
        wayfield.evaluate_function(lambda rows: rows, actions="none", **options)


def test_a_model_card_lists_evaluations(run, tmp_path):
    evaluation = wayfield.evaluate(run.policy, episodes=5, rounds=2)
    page = run.policy.export_onnx(tmp_path / "policy.onnx", [evaluation]).read_text()
    assert f'"value":{evaluation.success_rate!r},"verified":false' in page and "over 10 episodes, seed 0" in page
    with pytest.raises(ValueError, match="results are those of another policy: .*; help:"):
        wayfield.Policy.load("scenario-1").export_onnx(tmp_path / "other.onnx", [evaluation])
    with_map = wayfield.evaluate(f"{run.folder / 'policy.safetensors'}+map", episodes=5, rounds=1)
    with pytest.raises(ValueError, match="results are those of the policy with a map, .*; help:"):
        run.policy.export_onnx(tmp_path / "map.onnx", [with_map])


def test_several_policies_drive_the_same_episodes(run):
    shipped = wayfield.Policy.load("scenario-1")
    printed = cli("--eval", "scenario-1", run.folder / "policy.safetensors", "--episodes", 10, "--rounds", 2)["policies"]
    ours = wayfield.evaluate([shipped, run.folder / "policy.safetensors"], episodes=10, rounds=2)
    for result, expected in zip(ours, printed, strict=True):
        assert (result.success_rate, result.mean_cost_s, result.spl) == (
            expected["success_rate"],
            expected["mean_cost_s"],
            expected["spl"],
        )
    assert (ours[0].episodes["start_x_m"] == ours[1].episodes["start_x_m"]).all()
    with pytest.raises(ValueError, match="so that they drive the same episodes"):
        wayfield.evaluate(["scenario-1", "scenario-2"], episodes=1, rounds=1)
    with pytest.raises(ValueError, match="the list of policies is empty; help:"):
        wayfield.evaluate([])


def test_classical_drivers_have_the_results_of_the_command_line(tmp_path):
    (tmp_path / "mine.ron").write_text("Dwa(horizon_s: 1.0)")
    drivers = ["field", "scenario-1", str(tmp_path / "mine.ron"), "scenario-1+map"]
    printed = cli("--eval", *drivers, "orca", "--seed", 3, "--episodes", 8, "--rounds", 2)["policies"]
    ours = wayfield.evaluate([*drivers, "orca"], seed=3, episodes=8, rounds=2)
    for result, expected in zip(ours, printed, strict=True):
        for key in ("success_rate", "mean_cost_s", "spl", "weights_crc32c", "scenario"):
            assert getattr(result, key) == expected[key], key
        assert result.driver_class == expected["class"]
    assert [result.driver_class for result in ours] == ["A", "A", "A", "B", "C"]
    by_text = wayfield.evaluate("Dwa(horizon_s: 1.0)", seed=3, episodes=8, rounds=2)
    assert (by_text.mean_cost_s, by_text.scenario) == (ours[2].mean_cost_s, "Scenario I")
    with pytest.raises(FileNotFoundError, match="a driver .field, dwa.* or its RON file"):
        wayfield.evaluate("dwaa")
    with pytest.raises(ValueError, match="horizon_s` is 0; help: give 0.1 to 60"):
        wayfield.evaluate("Dwa(horizon_s: 0)")


def test_a_trace_is_that_of_the_command_line(run, tmp_path):
    policies = ["scenario-1", str(run.folder / "policy.safetensors")]
    cli("--eval", *policies, "--seed", 3, "--episodes", 2, "--rounds", 1, "--trace", tmp_path / "cli.jsonl")
    options = {"seed": 3, "episodes": 2, "rounds": 1}
    traced = wayfield.evaluate(policies, trace=tmp_path / "python.jsonl", **options)
    assert (tmp_path / "python.jsonl").read_bytes() == (tmp_path / "cli.jsonl").read_bytes()
    assert traced[1].mean_cost_s == wayfield.evaluate(policies[1], **options).mean_cost_s
    with pytest.raises(ValueError, match="can't be written: the folder .* help: create it"):
        wayfield.evaluate("scenario-1", trace=tmp_path / "no/such.jsonl", **options)
    with pytest.raises(ValueError, match="gives 12 numbers .* help:"):
        wayfield.evaluate("scenario-1", '(name: "x", lidar: (beams: 8))', trace=tmp_path / "python.jsonl", **options)
    assert (tmp_path / "python.jsonl").read_bytes() == (tmp_path / "cli.jsonl").read_bytes(), "a failure keeps the file"


def test_an_evaluation_can_be_compared_with_the_optimum(run):
    result = wayfield.evaluate(run.policy, episodes=5, rounds=1, optimum=True)
    assert 0.9 < result.time_ratio < 2 and result.optimum_mean_time_s > 0
    assert np.isfinite(result.episodes["optimal_time_s"]).all()
    assert wayfield.evaluate(run.policy, episodes=2, rounds=1).time_ratio is None


def test_a_policy_in_another_scenario_gives_a_warning(run):
    with pytest.warns(UserWarning, match="LIDAR noise: 0 m on its card, 0.02 m here") as warned:
        wayfield.evaluate(run.policy, set={"scenario.lidar.noise_std_m": 0.02}, episodes=2, rounds=1)
    assert warned[0].filename == __file__
    with pytest.raises(ValueError, match="has no benchmark route; help:"):
        wayfield.evaluate(run.policy, '(name: "x")', episodes=1, benchmark_route=True)


def test_a_policy_driven_from_python_solves_scenario_1():
    policy = wayfield.Policy.load("scenario-1")
    envs = gymnasium.make_vec("wayfield/Navigation-v0", num_envs=64, scenario="scenario-1")
    observations, _ = envs.reset(seed=11)
    ends, successes = 0, 0
    for _ in range(600):
        observations, _, terminated, truncated, info = envs.step(policy.act(observations))
        ends += (terminated | truncated).sum()
        successes += info["is_success"].sum()
    assert ends > 300 and successes / ends > 0.97


def test_a_policy_takes_one_observation_or_a_batch():
    policy = wayfield.Policy.load("scenario-1")
    batch = np.random.default_rng(1).uniform(0, 1, (10, 28)).astype(np.float32)
    values = policy.q_values(batch)
    assert values.shape == (10, 5) and (policy.q_values(batch[3]) == values[3]).all()
    assert policy.act(batch).tolist() == values.argmax(axis=1).tolist()
    velocities = policy.velocities(batch)
    assert velocities.shape == (10, 2) and set(velocities[:, 0].tolist()) == {np.float32(0.15).item()}
    with pytest.raises(ValueError, match="help: give"):
        policy.act(batch[:, :20])
    with pytest.raises(ValueError, match="help: give 24 of them"):
        policy.encode([1.0] * 20, 0.0, 1.0)
    row = policy.encode([3.5] * 24, np.pi, 2.0)
    assert row[24:27].tolist() == [1.0, 0.5, 1.0]


def test_a_policy_can_be_copied_and_saved(tmp_path):
    policy = wayfield.Policy.load("scenario-1")
    copy = pickle.loads(pickle.dumps(policy))
    copy.save(tmp_path / "copy.safetensors")
    again = wayfield.Policy.load(tmp_path / "copy.safetensors")
    assert again.card == policy.card and policy.card["actions"]
    assert again.network == policy.network


def test_a_policy_is_exported_as_onnx(tmp_path):
    card = wayfield.Policy.load("scenario-1").export_onnx(tmp_path / "policy.onnx")
    subprocess.run(
        [sys.executable, "-m", "wayfield", "--export", policy_file(tmp_path), "--onnx", tmp_path / "cli.onnx"], check=True
    )
    assert card == tmp_path / "README.md"
    assert (tmp_path / "policy.onnx").read_bytes() == (tmp_path / "cli.onnx").read_bytes()
    with pytest.raises(ValueError, match="help: give a file name that ends in .onnx"):
        wayfield.Policy.load("scenario-1").export_onnx(tmp_path / "policy.txt")


def test_a_policy_that_is_missing_or_broken_is_an_exception(tmp_path):
    with pytest.raises(FileNotFoundError, match="help:"):
        wayfield.Policy.load(tmp_path / "no.safetensors")
    (tmp_path / "broken.safetensors").write_bytes(b"no")
    with pytest.raises(ValueError, match="not a safetensors file.*help:"):
        wayfield.Policy.load(tmp_path / "broken.safetensors")


def test_a_callback_sees_the_progress_and_stops_the_run(tmp_path):
    seen = []

    def callback(progress):
        seen.append(progress)
        return progress["env_steps"] < 5_000

    result = wayfield.train(steps=10_000_000, out=tmp_path / "run", callback=callback, progress=False)
    assert not result.summary["finished"] and result.summary["env_steps"] < 1_000_000
    assert seen[-1]["env_steps"] >= 5_000 and seen[-1]["episodes"] > 0
    for steps in (0, 10**16):
        with pytest.raises(ValueError, match="budget"):
            wayfield.resume(result.folder, steps=steps, progress=False)
    resumed = wayfield.resume(result.folder, steps=result.summary["env_steps"] + 1_000, progress=False)
    assert resumed.summary["finished"]


def test_an_exception_of_the_callback_is_raised_after_the_run_was_saved(tmp_path):
    def callback(progress):
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine") as raised:
        wayfield.train(steps=10_000_000, out=tmp_path / "run", callback=callback, progress=False)
    assert "wayfield.resume" in raised.value.__notes__[0]
    assert (tmp_path / "run/summary.json").exists()


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGINT for one process")
@pytest.mark.parametrize("call", ["train", "evaluate", "evaluate_function"])
def test_ctrl_c_interrupts_long_calls(call, tmp_path):
    # A background job starts with SIGINT ignored.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    timer = threading.Timer(0.7, lambda: os.kill(os.getpid(), signal.SIGINT))
    began = time.monotonic()
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            if call == "train":
                wayfield.train(steps=10**12, out=tmp_path / "run", progress=False)
            elif call == "evaluate_function":
                # No Python code runs in it that would notice Ctrl-C.
                first_two = operator.itemgetter((slice(None), slice(0, 2)))
                wayfield.evaluate_function(first_two, actions="continuous", episodes=100_000, rounds=10)
            else:
                wayfield.evaluate("scenario-1", episodes=100_000, rounds=10)
    finally:
        signal.signal(signal.SIGINT, before)
    assert time.monotonic() - began < 60
    if call == "train":
        assert wayfield.load_run(tmp_path / "run").summary["finished"] is False


def test_settings_are_those_of_the_command_line(tmp_path):
    settings = {"learning.gamma": 0.9, "scenario.lidar.noise_std_m": 0.02, "arenas": 4}
    words = [word for path, value in settings.items() for word in ("--set", f"{path}={value}")]
    cli("--train", "--steps", 2_000, "--out", tmp_path / "cli", *words)
    result = wayfield.train(steps=2_000, out=tmp_path / "python", set=settings, progress=False)
    assert (tmp_path / "cli/config.ron").read_text() == (result.folder / "config.ron").read_text()
    assert (tmp_path / "cli/policy-last.safetensors").read_bytes() == result.last_policy._native.to_bytes()
    with pytest.raises(ValueError, match="learning.gama=0.9.*did you mean `gamma`"):
        wayfield.train(set={"learning.gama": 0.9}, out=tmp_path / "no")
    with pytest.raises(ValueError, match="help:"):
        wayfield.evaluate("scenario-1", set={"learning.gamma": 0.9})


def test_settings_may_be_numpy_scalars():
    settings = {"a": np.bool_(True), "b": (np.float32(0.1), np.int64(3)), "c": [np.bool_(False)], "d": np.str_("Greedy")}
    assert _settings.pairs(settings) == [("a", "true"), ("b", "(0.1, 3)"), ("c", "[false]"), ("d", "Greedy")]


def test_training_starts_from_a_policy(run, tmp_path):
    options = {"init": run.policy, "epsilon": 0.1, "steps": 2_000, "progress": False}
    result = wayfield.train("scenario-2", out=tmp_path / "run", **options)
    assert result.policy.card["training"]["env_steps"] <= 2_000
    assert (tmp_path / "run/policy-init.safetensors").exists()


def test_invalid_options_are_exceptions_and_leave_no_folder(tmp_path):
    out = tmp_path / "run"
    with pytest.raises(FileNotFoundError, match="did you mean `fast`"):
        wayfield.train(preset="fsat", out=out)
    with pytest.raises(ValueError, match="budget"):
        wayfield.train(steps=0, out=out)
    with pytest.raises(ValueError, match="help: give one of them"):
        wayfield.train(steps=1, episodes=1, out=out)
    with pytest.raises(ValueError, match="episodes; help: give 1 to"):
        wayfield.evaluate("scenario-1", episodes=0)
    assert not out.exists()


def test_files_are_checked_and_drawn(tmp_path):
    assert "scenario-1" in wayfield.scenarios() and "fast" in wayfield.presets()
    good, bad = tmp_path / "good.ron", tmp_path / "bad.ron"
    good.write_text(wayfield.scenario_text("hall"))
    bad.write_text('(name: "x",\n lidar: (beams: 0))')
    assert [p for p in wayfield.check(good) if p.level == "error"] == []
    (problem,) = wayfield.check(bad)
    assert problem.line == 2 and "bad.ron:2:17: error: `lidar.beams` is 0" in str(problem) and problem.level == "error"
    wayfield.draw("hall", tmp_path / "hall.svg")
    assert (tmp_path / "hall.svg").read_text().startswith("<svg")
    with pytest.raises(ValueError, match="help: give a file name that ends in .svg"):
        wayfield.draw("hall", tmp_path / "hall.gif")


def test_drawings_are_those_of_the_command_line(run, tmp_path):
    room = tmp_path / "room.pgm"
    rows = [[0 if x in (0, 39) or y in (0, 29) else 254 for x in range(40)] for y in range(30)]
    room.write_bytes(b"P5\n40 30\n255\n" + bytes(v for row in rows for v in row))
    (tmp_path / "room.ron").write_text(wayfield.import_scenario(room, resolution=0.1).text)

    def drawn(draw, *words):
        command = [sys.executable, "-m", "wayfield", "--draw", tmp_path / "cli.svg", *map(str, words)]
        subprocess.run(command, check=True, capture_output=True)
        draw(tmp_path / "python.svg")
        return (tmp_path / "python.svg").read_bytes() == (tmp_path / "cli.svg").read_bytes()

    sheet = ("--scenario", "clutter", "--levels", 3, "--seed", 5)
    assert drawn(lambda path: wayfield.draw("clutter", path, levels=3, seed=5), *sheet)
    over = ("--scenario", tmp_path / "room.ron", "--over", room, "--resolution", 0.1)
    assert drawn(lambda path: wayfield.draw(tmp_path / "room.ron", path, over=room, resolution=0.1), *over)
    small = ("--scenario", "hall", "--size", "320x200", "--plain", "--set", "scenario.robot.radius_m=0.05")
    settings = {"scenario.robot.radius_m": 0.05}
    assert drawn(lambda path: wayfield.draw("hall", path, size=(320, 200), plain=True, set=settings), *small)
    assert drawn(run.draw, "--run", run.folder)
    for options in ({"size": (1, 1)}, {"levels": 0}, {"levels": 3, "plain": True}, {"seed": 3, "scenario": "hall"}):
        with pytest.raises(ValueError, match="help: "):
            wayfield.draw(options.pop("scenario", "clutter"), tmp_path / "no.svg", **options)


def test_the_command_line_is_there():
    output = subprocess.run([sys.executable, "-m", "wayfield", "--version"], check=True, capture_output=True, text=True)
    assert output.stdout.split() == ["wayfield", wayfield.__version__]
    wrong = subprocess.run([sys.executable, "-m", "wayfield", "--eval", "no"], capture_output=True, text=True)
    assert wrong.returncode == 2 and "error: no" in wrong.stderr


def test_the_stub_lists_the_native_module():
    stub = ast.parse((Path(wayfield.__file__).parent / "_native.pyi").read_text())
    listed = {node.name: node for node in stub.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
    assert set(listed) == {name for name in dir(_native) if not name.startswith("_")}
    for name in ("NativeDriver", "NativeEnv", "NativePolicy", "NativeReport", "StepDetails"):
        members = {node.name for node in listed[name].body if isinstance(node, ast.FunctionDef)}
        members |= {node.target.id for node in listed[name].body if isinstance(node, ast.AnnAssign)}
        native = {member for member in vars(getattr(_native, name)) if not member.startswith("__")}
        assert members - {"__new__"} == native


def test_a_map_is_imported_as_a_scenario_to_train_in(tmp_path):
    rows = [[0 if x in (0, 39) or y in (0, 29) else 254 for x in range(40)] for y in range(30)]
    (tmp_path / "room.pgm").write_bytes(b"P5\n40 30\n255\n" + bytes(v for row in rows for v in row))
    imported = wayfield.import_scenario(tmp_path / "room.pgm", resolution=0.1, set={"scenario.lidar.beams": 36})
    assert "beams: 36" in imported.text and imported.deviation_m <= 0.11 and imported.findings == []
    assert gymnasium.make("wayfield/Navigation-v0", scenario=imported.text).observation_space.shape == (40,)
    boxes = '[{"box": [0, 1, 3, 0.1, 0]}, {"box": [0, -1, 3, 0.1, 0]}]'
    (tmp_path / "stages.json").write_text('{"stages": {"1": {"static": ' + boxes + "}}}")
    stage = wayfield.import_scenario(tmp_path / "stages.json", world=1, set={"scenario.lidar.beams": 36})
    assert "beams: 36" in stage.text and "radius_m: 0.105" in stage.text
    with pytest.raises(ValueError, match="help: give the side of a pixel"):
        wayfield.import_scenario(tmp_path / "room.pgm")
    with pytest.raises(FileNotFoundError):
        wayfield.import_scenario(tmp_path / "none.yaml")
