"""Searches for settings with Optuna, in as many processes as you start:

    pip install './python[sweep]'
    python python/examples/optuna_search.py & python python/examples/optuna_search.py

The processes share a journal file, on one machine or on a network file system. For machines without a common file system, give
Optuna the address of a database instead.
"""

import optuna
from optuna.storages import JournalStorage
from optuna.storages.journal import JournalFileBackend

import wayfield

TRIALS, STEPS = 20, 30_000


def objective(trial: optuna.Trial) -> float:
    settings = {
        "learning.gamma": trial.suggest_float("gamma", 0.9, 0.99),
        "learning.batch_size": trial.suggest_categorical("batch_size", [32, 64, 128]),
        "reward.mu": trial.suggest_float("mu", 10.0, 200.0, log=True),
    }
    # A trial has three seeds: the result of a single one depends more on luck than on the settings.
    costs = []
    for seed in (1, 2, 3):
        out = f"optuna/trial-{trial.number}-seed-{seed}"
        run = wayfield.train("scenario-1", set=settings, seed=seed, steps=STEPS, out=out, progress=False)
        # The mean time to the goal in s; a failure counts as the whole time limit.
        costs.append(wayfield.evaluate(run.last_policy, episodes=200, rounds=1).mean_cost_s)
    return sum(costs) / len(costs)


if __name__ == "__main__":
    storage = JournalStorage(JournalFileBackend("optuna.journal"))
    study = optuna.create_study(study_name="fast", storage=storage, direction="minimize", load_if_exists=True)
    study.optimize(objective, callbacks=[optuna.study.MaxTrialsCallback(TRIALS)])
    print(f"{len(study.trials)} trials; the best has a mean cost of {study.best_value:.2f} s: {study.best_params}")
