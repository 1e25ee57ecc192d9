"""Three gradient steps of double DQN with switches (options that are off by default), in plain Python and float64.

Writes switches.json, with which crates/learning/tests/pytorch_reference.rs compares the learner. Nothing here is derived
from wayfield's code, and no gradient is derived by hand: a derivative is the imaginary part of the loss after a tiny
imaginary step of the parameter, divided by that step, which is exact up to rounding. The formulas are those of PyTorch's
LayerNorm, ELU, SiLU, clip_grad_norm_ and AdamW; with RMSprop the weights decay as in AdamW. With all switches off the script
reproduces PyTorch's results, which it checks against learning_step.json.

    python3 crates/learning/tests/reference/switches.py
"""

import cmath
import json
import math
import pathlib

from transitions import ACTIONS, GRADIENT_STEPS, HIDDEN, INPUTS, observation, transitions

LEARNING_RATE = 0.01
ACTIVATIONS = {
    "Relu": lambda x: x if x.real > 0 else 0j,
    "Elu": lambda x: x if x.real > 0 else cmath.exp(x) - 1,
    "Silu": lambda x: x / (1 + cmath.exp(-x)),
    "Tanh": cmath.tanh,
}


def q_values(case, parameters, x):
    """The Q-values of the observation x. Parameters are in wayfield's order."""
    rest = iter(parameters)
    take = lambda n: [next(rest) for _ in range(n)]

    def dense(x, outputs):
        weight, bias = take(len(x) * outputs), take(outputs)
        rows = (weight[k * len(x) : (k + 1) * len(x)] for k in range(outputs))
        return [sum(w * v for w, v in zip(row, x)) + b for row, b in zip(rows, bias)]

    for width in HIDDEN:
        x = dense(x, width)
        if case["layer_norm"]:
            mean = sum(x) / width
            root = cmath.sqrt(sum((v - mean) ** 2 for v in x) / width + 1e-5)
            x = [(v - mean) / root * scale + shift for v, scale, shift in zip(x, take(width), take(width))]
        x = [ACTIVATIONS[case["activation"]](v) for v in x]
    head = dense(x, ACTIONS + case["dueling"])
    assert next(rest, None) is None, "all parameters are used"
    if not case["dueling"]:
        return head
    value, advantages = head[0], head[1:]
    return [value + a - sum(advantages) / ACTIONS for a in advantages]


def number_of_parameters(case):
    widths = [INPUTS, *HIDDEN]
    hidden = sum((i + 1) * o + 2 * o * case["layer_norm"] for i, o in zip(widths, widths[1:]))
    return hidden + (widths[-1] + 1) * (ACTIONS + case["dueling"])


def td_errors(case, parameters, targets):
    chosen = [q_values(case, parameters, observation(t[0]))[t[1]] for t in transitions()]
    return [q - y for q, y in zip(chosen, targets)], chosen


def loss(case, errors):
    if case["loss"] == "mse":
        return sum(d * d for d in errors) / len(errors)
    huber = lambda d: d * d / 2 if abs(d.real) <= 0.5 else 0.5 * ((d if d.real > 0 else -d) - 0.25)
    return sum(map(huber, errors)) / len(errors)


def gradient(case, parameters, targets):
    tiny, out = 1e-40j, []
    for k in range(len(parameters)):
        moved = [*parameters]
        moved[k] += tiny
        out.append((loss(case, td_errors(case, moved, targets)[0]) / tiny).real)
    return out


def td_targets(case, online, target):
    out = []
    for _, _, reward, discount, last in transitions():
        chooser_q = [q.real for q in q_values(case, online, observation(last))]
        best = chooser_q.index(max(chooser_q))
        out.append(reward + discount * q_values(case, target, observation(last))[best].real)
    return out


def clipped(case, g):
    norm = math.sqrt(sum(x * x for x in g))
    limit = case["max_gradient_norm"]
    if limit is None:
        return g
    assert norm > limit, f"a norm of {norm} is not clipped"
    return [x * min(1, limit / (norm + 1e-6)) for x in g]


def run(case):
    n = number_of_parameters(case)
    online = [((i * 37 + 11) % 101 - 50) / 60 for i in range(n)]
    target, first, second = [*online], [0.0] * n, [0.0] * n
    losses, errors, values = [], [], []
    for step in range(1, GRADIENT_STEPS + 1):
        y = td_targets(case, online, target)
        d, chosen = td_errors(case, online, y)
        losses.append(loss(case, d).real)
        errors.append(sum(abs(x.real) for x in d) / len(d))
        values.append(sum(q.real for q in chosen) / len(d))
        for k, g in enumerate(clipped(case, gradient(case, online, y))):
            online[k] *= 1 - LEARNING_RATE * case["weight_decay"]
            if case["optimizer"] == "rmsprop":
                second[k] = 0.9 * second[k] + 0.1 * g * g
                online[k] -= LEARNING_RATE * g / (math.sqrt(second[k]) + 1e-7)
            else:
                first[k] = 0.9 * first[k] + 0.1 * g
                second[k] = 0.999 * second[k] + 0.001 * g * g
                mean, square = first[k] / (1 - 0.9**step), second[k] / (1 - 0.999**step)
                online[k] -= LEARNING_RATE * mean / (math.sqrt(square) + 1e-8)
        if case["target_update"] == "soft":
            target = [t + 0.1 * (p - t) for t, p in zip(target, online)]
        elif step % 2 == 0:
            target = [*online]
    mean = lambda x: sum(x) / len(x)
    results = {"mean_loss": mean(losses), "mean_td_error": mean(errors), "mean_q": mean(values)}
    return case | results | {"online": online, "target": target}


OFF = {"activation": "Relu", "layer_norm": False, "max_gradient_norm": None, "weight_decay": 0.0}


def check_against_pytorch(folder):
    for case in json.loads((folder / "learning_step.json").read_text())["cases"]:
        if case["double"]:
            found = run(case | OFF)
            assert all(abs(a - b) < 1e-12 for a, b in zip(found["online"], case["online"])), case


def case(dueling, loss, optimizer, target_update, activation, layer_norm, max_gradient_norm, weight_decay):
    return locals() | {"double": True}


if __name__ == "__main__":
    check_against_pytorch(pathlib.Path(__file__).parent)
    cases = [
        case(True, "mse", "rmsprop", "hard", "Relu", True, 0.2, 0.0),
        case(False, "huber", "adam", "soft", "Elu", False, None, 0.1),
        case(True, "mse", "adam", "hard", "Silu", True, 0.3, 0.5),
        case(True, "huber", "rmsprop", "soft", "Tanh", False, 0.1, 1.0),
    ]
    path = pathlib.Path(__file__).with_suffix(".json")
    path.write_text(json.dumps({"cases": [run(case) for case in cases]}, indent=1) + "\n")
