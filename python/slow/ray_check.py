"""The slow check of wayfield.cluster, which CI leaves out because Ray brings hundreds of megabytes.

    pip install './python[cluster]'
    python python/slow/ray_check.py

Starts a Ray cluster of two nodes, reproduces an experiment on it, kills one node midway, and compares the report and the runs
byte for byte with those of a single process. Then compares a sweep and evaluations with those of a single process, too, without
killing a node.
"""

import filecmp
import os
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from pathlib import Path

import ray
from ray.cluster_utils import Cluster

import wayfield
from wayfield import cluster
from wayfield.cluster import RayPool

EXPERIMENT = """(
    title: "Transfer from an empty room",
    seeds: 3,
    test: (rounds: 2, episodes: 50, seed: 7),
    arms: [
        (name: "from scratch", stages: [(scenario: "scenario-1", preset: "fast", budget: EnvSteps(60000))]),
        (name: "transferred", stages: [
            (scenario: "empty", preset: "fast", budget: EnvSteps(30000)),
            (scenario: "scenario-1", preset: "fast", budget: EnvSteps(30000), epsilon: 0.5),
        ]),
    ],
    figures: [(name: "success", title: "Success", draw: DotPlot(measures: [Success, MeanTime]))],
    tables: [(name: "all", title: "All measures", show: Measures(measures: [Success, MeanTime, TimeRatio]))],
)"""

#: Files that are not compared: those that contain times, and locks.
TIMED = ("spent.json", "lock", "summary.json", "episodes.csv", "evaluations.csv")


class WatchedPool(RayPool):
    """A pool on Ray that counts the tasks done by each node, and calls ``kill`` after two tasks."""

    def __init__(self, kill):
        super().__init__(cpus=1, retries=5)
        self.kill, self.where = kill, Counter()

    def wait(self, handles):
        handle, result, where = super().wait(handles)
        self.where[where] += 1
        if self.kill is not None and sum(self.where.values()) == 2:
            # Half a second later, the node to kill has started its next task.
            threading.Timer(0.5, self.kill).start()
            self.kill = None
        return handle, result, where


def compare(ours: Path, theirs: Path) -> tuple[int, list[str]]:
    """Compares the files in ``theirs`` with those in ``ours``. Returns the number of files compared, and the paths of those that
    differ. In pages, ignores the line with the time."""

    def contents(path: Path) -> list[bytes]:
        lines = path.read_bytes().splitlines()
        return [line for line in lines if b"minutes with" not in line] if path.suffix in (".md", ".html") else lines

    names = [path.relative_to(theirs) for path in theirs.rglob("*") if path.is_file()]
    names = [name for name in names if name.name not in TIMED and "events.out" not in name.name]
    return len(names), [
        str(name) for name in names if not (ours / name).is_file() or contents(ours / name) != contents(theirs / name)
    ]


def check_reproduction(nodes: Cluster) -> None:
    second = nodes.add_node(num_cpus=1)
    nodes.wait_for_nodes()
    print(f"{len(ray.nodes())} nodes with {ray.cluster_resources()['CPU']:.0f} CPUs")

    def kill() -> None:
        print("killing the second node", file=sys.stderr, flush=True)
        nodes.remove_node(second, allow_graceful=False)

    pool = WatchedPool(kill)
    os.makedirs("cluster", exist_ok=True)
    os.chdir("cluster")
    done = cluster.reproduce("../own.ron", out="report", pool=pool)
    print(f"the report is made of {done.runs} runs in {done.wall_s:.0f} s; done by {dict(pool.where)}")
    alive = sum(node["Alive"] for node in ray.nodes())
    assert alive == 1 and len(pool.where) == 2, "both nodes worked, and one was killed"
    os.makedirs("../alone", exist_ok=True)
    os.chdir("../alone")
    command = [sys.executable, "-m", "wayfield", "--reproduce", "--experiment", "../own.ron", "--out", "report"]
    subprocess.run(command, check=True, capture_output=True)
    os.chdir("..")
    count, different = compare(Path("cluster/report"), Path("alone/report"))
    print(f"{count} files compared with those of one process: {len(different)} differ {different or ''}")
    assert not different and count > 50
    os.chdir("cluster")
    again = WatchedPool(None)
    cluster.reproduce("../own.ron", out="report", pool=again)
    print(f"the same call again: {sum(again.where.values())} training runs")
    assert not again.where
    os.chdir("..")


def check_sweep() -> None:
    runs = [{"seed": seed, "steps": 10_000, "set": {"learning.gamma": gamma}} for seed in (1, 2) for gamma in (0.9, 0.97)]
    results = cluster.sweep(runs, "sweep", progress=False)
    for index, (run, result) in enumerate(zip(runs, results, strict=True)):
        alone = wayfield.train(out=f"alone-{index}", progress=False, **run)
        same = filecmp.cmp(result.folder / "policy-last.safetensors", alone.folder / "policy-last.safetensors", False)
        assert same, run
    print(f"a sweep of {len(runs)} training runs: the same policies as wayfield.train, bit for bit")


def check_evaluations() -> None:
    cases = [{"policy": "scenario-1", "scenario": name, "episodes": 50, "rounds": 1} for name in ("scenario-1", "empty")]
    results = cluster.evaluate(cases, "tests", progress=False)
    assert [result.success_rate for result in results] == [wayfield.evaluate(**case).success_rate for case in cases]
    print(f"{len(cases)} evaluations: the same success rates as wayfield.evaluate")


def main() -> None:
    nodes = Cluster(initialize_head=True, head_node_args={"num_cpus": 1})
    ray.init(address=nodes.address, log_to_driver=False)
    began = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        Path("own.ron").write_text(EXPERIMENT, encoding="utf-8")
        check_reproduction(nodes)
        check_sweep()
        check_evaluations()
        os.chdir("/")
    print(f"all passed in {time.monotonic() - began:.0f} s")
    ray.shutdown()
    nodes.shutdown()


if __name__ == "__main__":
    main()
