"""Searches for settings with Ray Tune and Optuna's search algorithm, on all nodes of a cluster:

    pip install './python[sweep]'
    python python/examples/tune_search.py

Only numbers come back from the nodes. The run folders stay in Ray's working folders there.
"""

from pathlib import Path

from ray import tune
from ray.tune.search.optuna import OptunaSearch

import wayfield

SPACE = {
    "learning.gamma": tune.uniform(0.9, 0.99),
    "learning.batch_size": tune.choice([32, 64, 128]),
    "reward.mu": tune.loguniform(10.0, 200.0),
}


def trial(settings: dict) -> dict:
    costs = []
    for seed in (1, 2, 3):
        run = wayfield.train("scenario-1", set=settings, seed=seed, steps=30_000, out=f"run-{seed}", progress=False)
        # The mean time to the goal in s; a failure counts as the whole time limit.
        costs.append(wayfield.evaluate(run.last_policy, episodes=200, rounds=1).mean_cost_s)
    return {"mean_cost_s": sum(costs) / len(costs)}


if __name__ == "__main__":
    config = tune.TuneConfig(metric="mean_cost_s", mode="min", search_alg=OptunaSearch(seed=1), num_samples=20)
    # With several nodes, `storage_path` must be a folder that all of them can reach.
    run_config = tune.RunConfig(name="fast", storage_path=str(Path("tune").absolute()))
    best = tune.Tuner(trial, param_space=SPACE, tune_config=config, run_config=run_config).fit().get_best_result()
    print(f"the best trial has a mean cost of {best.metrics['mean_cost_s']:.2f} s: {best.config}")
