"""Three gradient steps of (double) (dueling) DQN on a small fixed replay buffer, in float64 PyTorch.

Writes learning_step.json, with which crates/learning/tests/pytorch_reference.rs compares the learner. Nothing here is
derived from wayfield's code: returns follow their definition; gradients and optimizers are those of PyTorch.

    pip install torch && python crates/learning/tests/reference/learning_step.py
"""

import json
import pathlib

import torch

from transitions import ACTIONS, GRADIENT_STEPS, HIDDEN, INPUTS, observation, transitions

torch.set_default_dtype(torch.float64)


class Net(torch.nn.Module):
    def __init__(self, dueling):
        super().__init__()
        widths = [INPUTS, *HIDDEN]
        self.hidden = torch.nn.ModuleList(torch.nn.Linear(i, o) for i, o in zip(widths, widths[1:]))
        self.dueling = dueling
        if dueling:
            self.value = torch.nn.Linear(widths[-1], 1)
            self.advantage = torch.nn.Linear(widths[-1], ACTIONS)
        else:
            self.output = torch.nn.Linear(widths[-1], ACTIONS)

    def forward(self, x):
        for layer in self.hidden:
            x = torch.relu(layer(x))
        if not self.dueling:
            return self.output(x)
        a = self.advantage(x)
        return self.value(x) + a - a.mean(dim=1, keepdim=True)

    def ordered(self):
        """Parameters in wayfield's order: hidden layers, then the weights of all heads, then their biases."""
        heads = [self.value, self.advantage] if self.dueling else [self.output]
        out = [p for layer in self.hidden for p in (layer.weight, layer.bias)]
        return out + [h.weight for h in heads] + [h.bias for h in heads]


def run(dueling, double, loss, optimizer, target_update):
    online, target = Net(dueling), Net(dueling)
    i = 0
    with torch.no_grad():
        for p in online.ordered():
            for k in range(p.numel()):
                p.view(-1)[k] = ((i * 37 + 11) % 101 - 50) / 60
                i += 1
    target.load_state_dict(online.state_dict())
    batch = transitions()
    s = torch.tensor([observation(t[0]) for t in batch])
    a = torch.tensor([[t[1]] for t in batch])
    r = torch.tensor([t[2] for t in batch])
    d = torch.tensor([t[3] for t in batch])
    s2 = torch.tensor([observation(t[4]) for t in batch])
    if optimizer == "rmsprop":
        opt = torch.optim.RMSprop(online.parameters(), lr=0.01, alpha=0.9, eps=1e-7)
    else:
        opt = torch.optim.Adam(online.parameters(), lr=0.01, betas=(0.9, 0.999), eps=1e-8)
    losses, errors, values = [], [], []
    for step in range(1, GRADIENT_STEPS + 1):
        with torch.no_grad():
            best = (online if double else target)(s2).argmax(dim=1, keepdim=True)
            y = r + d * target(s2).gather(1, best).squeeze(1)
        q = online(s).gather(1, a).squeeze(1)
        cost = torch.nn.functional.mse_loss(q, y) if loss == "mse" else torch.nn.functional.huber_loss(q, y, delta=0.5)
        opt.zero_grad()
        cost.backward()
        opt.step()
        losses.append(cost.item())
        errors.append((q - y).abs().mean().item())
        values.append(q.mean().item())
        with torch.no_grad():
            for t, p in zip(target.parameters(), online.parameters()):
                if target_update == "soft":
                    t += 0.1 * (p - t)
                elif step % 2 == 0:
                    t.copy_(p)
    mean = lambda x: sum(x) / len(x)
    return {
        "dueling": dueling,
        "double": double,
        "loss": loss,
        "optimizer": optimizer,
        "target_update": target_update,
        "mean_loss": mean(losses),
        "mean_td_error": mean(errors),
        "mean_q": mean(values),
        "online": torch.cat([p.detach().reshape(-1) for p in online.ordered()]).tolist(),
        "target": torch.cat([p.detach().reshape(-1) for p in target.ordered()]).tolist(),
    }


if __name__ == "__main__":
    cases = [
        run(True, True, "mse", "rmsprop", "hard"),
        run(True, True, "huber", "adam", "soft"),
        run(False, True, "mse", "adam", "hard"),
        run(False, False, "huber", "rmsprop", "soft"),
    ]
    path = pathlib.Path(__file__).with_suffix(".json")
    path.write_text(json.dumps({"torch": torch.__version__, "cases": cases}, indent=1) + "\n")
