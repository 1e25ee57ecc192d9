"""Tests of wayfield.cluster without Ray: which tasks there are, what they return, and what is not repeated."""

import json
import os
import signal
import subprocess
import sys
import threading
import types
import warnings

import numpy as np
import pytest

import wayfield
from wayfield import _work, cluster
from wayfield._folders import pack, unpack

EXPERIMENT = """(
    title: "Small",
    seeds: 2,
    test: (rounds: 1, episodes: 4, seed: 7),
    evaluation: (every_env_steps: 1000, episodes: 4),
    overrides: {"learning.network.hidden": [16], "arenas": 4},
    arms: [
        (name: "plain", stages: [(scenario: "scenario-1", preset: "fast", budget: EnvSteps(2000))]),
        (name: "transferred", stages: [
            (scenario: "empty", preset: "fast", budget: EnvSteps(1000)),
            (scenario: "scenario-1", preset: "fast", budget: EnvSteps(1000), epsilon: 0.5),
        ]),
    ],
    figures: [(name: "dots", title: "Dots", draw: DotPlot(measures: [Success]))],
    tables: [(name: "all", title: "All", show: Measures(measures: [Success, MeanTime]))],
)"""
RUNS = 6
SMALL = {"steps": 1_000, "set": {"learning.network.hidden": [16], "arenas": 4}}


class OneProcess:
    """A pool that does one task after the other in this process. With ``stop_after``, it fails after that many tasks."""

    parallel = 1

    def __init__(self, stop_after=None):
        self.names, self.cancelled, self.stop_after, self.queue = [], [], stop_after, {}

    def submit(self, name, work, arguments):
        self.names.append(name)
        self.queue[name] = (work, arguments)
        return name

    def wait(self, handles):
        if self.stop_after == 0:
            raise RuntimeError("lost")
        if self.stop_after is not None:
            self.stop_after -= 1
        work, arguments = self.queue.pop(handles[0])
        return handles[0], work(*arguments), "here"

    def cancel(self, handles):
        self.cancelled += handles


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "own.ron").write_text(EXPERIMENT)
    return tmp_path


def reproduce(pool):
    return cluster.reproduce("own.ron", out="report", progress=False, pool=pool)


def files(folder):
    """The contents of the files of a report and of its runs, by path, without files and lines that contain times."""

    def contents(path):
        lines = path.read_bytes().splitlines(keepends=True)
        return [line for line in lines if b"minutes with" not in line] if path.suffix in (".md", ".html") else lines

    timed = ("spent", "lock", "summary.json", "episodes.csv", "evaluations.csv", "events.out")
    return {
        path.relative_to(folder).as_posix(): contents(path)
        for path in folder.rglob("*")
        if path.is_file() and not path.name.startswith(timed)
    }


def test_the_report_is_the_same_as_on_one_machine(folder):
    done = reproduce(OneProcess())
    assert (done.runs, done.report.as_posix(), done.claims) == (RUNS, "report/report.html", [])
    (folder / "report").rename(folder / "of-cluster")
    command = [sys.executable, "-m", "wayfield", "--reproduce", "--experiment", "own.ron", "--out", "report"]
    subprocess.run(command, check=True, capture_output=True)
    ours, theirs = files(folder / "of-cluster"), files(folder / "report")
    assert set(ours) == set(theirs) and len(ours) > 5 * RUNS
    assert [path for path, contents in theirs.items() if ours[path] != contents] == []
    assert b"wayfield --reproduce --experiment own.ron --out report" in b"".join(ours["README.md"])


def test_finished_runs_are_not_repeated(folder):
    first, second, third = OneProcess(stop_after=2), OneProcess(), OneProcess()
    with pytest.raises(RuntimeError, match="lost"):
        reproduce(first)
    assert first.cancelled, "the others are stopped"
    reproduce(second)
    assert len(second.names) == RUNS - 2
    reproduce(third)
    assert third.names == []


def test_a_run_waits_for_the_run_that_it_starts_from(folder):
    pool = OneProcess()
    reproduce(pool)
    first_stages = [name for name in pool.names if "empty" in name]
    configs = {name: (folder / f"report/runs/{name}/config.ron").read_text() for name in pool.names}
    pairs = [(origin, name) for name, text in configs.items() for origin in first_stages if f'policy: "{origin}/' in text]
    assert len(pairs) == 2, "one per seed"
    assert all(pool.names.index(origin) < pool.names.index(name) for origin, name in pairs)
    assert sum("/policy-after-" in text for text in configs.values()) == 2


@pytest.mark.parametrize("damage", [lambda path: path.unlink(), lambda path: path.write_text("{")])
def test_a_damaged_or_partial_run_is_done_again(folder, damage):
    reproduce(OneProcess())
    before = files(folder / "report")
    run = next((folder / "report/runs").glob("*empty*"))
    damage(run / "summary.json")
    pool = OneProcess()
    reproduce(pool)
    assert pool.names == [run.name]
    assert files(folder / "report") == before


def test_a_folder_in_use_is_refused(folder):
    class Nested(OneProcess):
        def submit(self, name, work, arguments):
            with pytest.raises(ValueError, match="another wayfield process is writing in it; help:"):
                reproduce(OneProcess())
            return super().submit(name, work, arguments)

    reproduce(Nested())


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGINT for one process")
def test_ctrl_c_interrupts_the_missing_runs_of_a_report(folder, monkeypatch):
    (folder / "own.ron").write_text(EXPERIMENT.replace("EnvSteps(2000)", "EnvSteps(100000000)"))
    monkeypatch.setattr(cluster, "run_tasks", lambda *_: None)
    # A background job starts with SIGINT ignored.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    timer = threading.Timer(1.5, lambda: os.kill(os.getpid(), signal.SIGINT))
    timer.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            reproduce(OneProcess())
    finally:
        timer.cancel()
        signal.signal(signal.SIGINT, before)
    assert not (folder / "report/report.html").exists()


def test_invalid_options_raise_exceptions(folder):
    with pytest.raises(ValueError, match="no.ron: no such file"):
        cluster.reproduce("no.ron", pool=OneProcess())
    with pytest.raises(ValueError, match="seeds: 3 is given twice"):
        cluster.reproduce("own.ron", seeds=[3, 3], pool=OneProcess())
    with pytest.raises(ValueError, match="did you mean `gamma`"):
        cluster.sweep([{"set": {"learning.gama": 0.9}}], "sweep", pool=OneProcess())
    with pytest.raises(ValueError, match="a case has a trace; help:"):
        cluster.evaluate([{"policy": "scenario-1", "trace": "x"}], "tests", pool=OneProcess())
    for case, why in [
        ({"episodes": 0}, "is 0 episodes; help:"),
        ({"scenario": "empty", "set": {"scenario.lidar.beams": 12}}, "gives 16 numbers .* help:"),
    ]:
        with pytest.raises(ValueError, match=why):
            cluster.evaluate([{"policy": "scenario-1", **case}], "tests", pool=OneProcess())
    for calls in (cluster.sweep, cluster.evaluate):
        with pytest.raises(ValueError, match="give 1 or more cpus"):
            calls([], "runs", cpus=0, pool=OneProcess())
    assert not any((folder / name).exists() for name in ("sweep", "tests", "runs"))


def test_a_node_with_another_build_refuses_the_task():
    with pytest.raises(RuntimeError, match="comes from 0.0.1; help: install the same wheel on every node"):
        _work.train("0.0.1", 1, "", {})


def test_ray_is_optional(folder, monkeypatch):
    monkeypatch.setitem(sys.modules, "ray", None)
    with pytest.raises(ImportError, match=r"help: pip install 'wayfield\[cluster\]'"):
        cluster.reproduce("own.ron", out="report")
    assert not (folder / "report").exists()


def test_an_error_of_ray_says_what_happened(monkeypatch):
    class Ray(types.ModuleType):
        class exceptions:
            RayError = type("RayError", (Exception,), {})
            RayTaskError = type("RayTaskError", (RayError,), {})
            WorkerCrashedError = type("WorkerCrashedError", (RayError,), {})
            NodeDiedError = type("NodeDiedError", (RayError,), {})
            RuntimeEnvSetupError = type("RuntimeEnvSetupError", (RayError,), {})

        def wait(self, handles, num_returns):
            return handles[:num_returns], handles[num_returns:]

        def get(self, handle):
            raise self.error

    ray = Ray("ray")
    monkeypatch.setitem(sys.modules, "ray", ray)
    pool = cluster.RayPool(cpus=1, retries=5)

    def message(error):
        ray.error, pool._names = error, {"handle": "run"}
        with pytest.raises(RuntimeError) as caught:
            pool.wait(["handle"])
        return str(caught.value)

    kept = "; help: make the same call again; finished work is kept"
    lost = "run: its process or node was lost more than 5 times"
    assert message(Ray.exceptions.NodeDiedError("gone\nlog")) == f"{lost} (NodeDiedError: gone){kept}"
    assert message(Ray.exceptions.WorkerCrashedError()) == f"{lost} (WorkerCrashedError: ){kept}"
    assert message(Ray.exceptions.RuntimeEnvSetupError("no pip")) == f"run: RuntimeEnvSetupError: no pip{kept}"


def test_tasks_that_no_node_can_run_are_reported(monkeypatch):
    class Ray(types.ModuleType):
        def is_initialized(self):
            return True

        def nodes(self):
            large = {"Alive": False, "Resources": {"CPU": 64.0}}
            return [large, {"Alive": True, "Resources": {}}, {"Alive": True, "Resources": {"CPU": 4.0}}]

        def remote(self, function):
            return types.SimpleNamespace(options=lambda **_: types.SimpleNamespace(remote=lambda *_: object()))

    monkeypatch.setitem(sys.modules, "ray", Ray("ray"))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        cluster.RayPool(cpus=4, retries=5).submit("fits", print, ())
        assert not caught
        pool = cluster.RayPool(cpus=8, retries=5)
        for name in ("one", "two"):
            pool.submit(name, print, ())
    (warning,) = caught
    assert "needs 8 CPUs, but the largest node of the cluster has 4" in str(warning.message)
    assert "help: give cpus=4" in str(warning.message)


def test_a_sweep_gives_the_same_policies_as_train(folder):
    origin = wayfield.train("empty", seed=1, out="origin", progress=False, **SMALL).policy
    runs = [{"seed": seed, **SMALL} for seed in (1, 2, 1)] + [{"init": origin, "epsilon": 0.3, **SMALL}]
    pool = OneProcess()
    results = cluster.sweep(runs, "sweep", progress=False, pool=pool)
    assert len(pool.names) == 3, "equal runs are done once"
    assert results[0].folder == results[2].folder
    observations = np.random.default_rng(1).uniform(0, 1, (20, 28)).astype(np.float32)
    for index, (run, result) in enumerate(zip(runs, results, strict=True)):
        alone = wayfield.train(out=f"alone-{index}", progress=False, **run)
        # The cards differ: they name the policy that training started from, which is only in memory in ``alone``.
        assert (result.last_policy.q_values(observations) == alone.last_policy.q_values(observations)).all()
        if "init" not in run:
            assert (result.folder / "policy.safetensors").read_bytes() == (alone.folder / "policy.safetensors").read_bytes()
        assert result.summary["env_steps"] == alone.summary["env_steps"]
    again = OneProcess()
    assert cluster.sweep(runs, "sweep", progress=False, pool=again)[3].summary == results[3].summary
    assert again.names == []


def test_evaluations_on_a_cluster_give_the_same_results_as_evaluate(folder):
    cases = [{"policy": "scenario-1", "scenario": name, "episodes": 5, "rounds": 2} for name in ("empty", "hall")]
    cases.append({"policy": wayfield.Policy.load("scenario-2"), "episodes": 3, "rounds": 1, "seed": 9})
    cases.append({"policy": "dwa", "scenario": "empty", "episodes": 3, "rounds": 1})
    cases.append({"policy": "scenario-1+map", "scenario": "empty", "episodes": 5, "rounds": 2})
    pool, again = OneProcess(), OneProcess()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        results = cluster.evaluate(cases, "tests", progress=False, pool=pool)
        alone = [wayfield.evaluate(**case) for case in cases]
    assert len(pool.names) == 5, "with a map it is another test"
    for result, expected in zip(results, alone, strict=True):
        assert (result.scenario, result.success_rate, result.mean_cost_s) == (
            expected.scenario,
            expected.success_rate,
            expected.mean_cost_s,
        )
        np.testing.assert_array_equal(result.episodes["steps"], expected.episodes["steps"])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        cluster.evaluate(cases, "tests", progress=False, pool=again)
        cluster.evaluate([{**cases[0], "seed": 1}], "tests", progress=False, pool=again)
    assert len(again.names) == 1, "another seed is another test"
    stored = [json.loads(path.read_text())["scenario"] for path in (folder / "tests").glob("*.json")]
    assert len(stored) == 6 and len(set(stored)) == 3


def test_a_folder_is_sent_as_it_is(tmp_path):
    (tmp_path / "run/deep").mkdir(parents=True)
    (tmp_path / "run/deep/file").write_bytes(bytes(range(256)))
    (tmp_path / "old").mkdir()
    (tmp_path / "old/left").write_text("from an interrupted run")
    packed = pack(tmp_path / "run")
    assert packed == pack(tmp_path / "run")
    unpack(packed, tmp_path / "old")
    assert [path.name for path in (tmp_path / "old").rglob("*")] == ["deep", "file"]
    assert (tmp_path / "old/deep/file").read_bytes() == bytes(range(256))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["old", "run"]
