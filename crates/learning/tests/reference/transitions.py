"""The replay buffer of learning_step.py and switches.py, and the options that all their cases share."""

INPUTS, HIDDEN, ACTIONS = 3, [4, 3], 2
GAMMA, N_STEP, REWARD_SCALE, GRADIENT_STEPS = 0.9, 2, 0.5, 3

# (state, action, reward, next state, terminated, truncated): one environment, three episodes, the last one unfinished.
STEPS = [
    (0, 0, 1.0, 1, False, False),
    (1, 1, -2.0, 2, False, False),
    (2, 1, 0.5, 3, False, False),
    (3, 0, 3.0, 4, True, False),
    (5, 1, 1.5, 6, False, False),
    (6, 0, -1.0, 7, False, False),
    (7, 1, 2.0, 8, False, True),
    (9, 0, 0.25, 10, False, False),
    (10, 1, -0.75, 11, False, False),
]


def observation(state):
    return [((state * 7 + j * 5) % 11 - 5) / 5 for j in range(INPUTS)]


def transitions():
    """(state, action, n-step return, discount, last state) of every step whose return is complete."""
    out = []
    for i, (state, action, *_) in enumerate(STEPS):
        total, discount = 0.0, 1.0
        for m, (_, _, reward, nxt, terminated, truncated) in enumerate(STEPS[i : i + N_STEP]):
            total += discount * reward * REWARD_SCALE
            discount *= GAMMA
            if terminated or truncated or m == N_STEP - 1:
                out.append((state, action, total, 0.0 if terminated else discount, nxt))
                break
    return out
