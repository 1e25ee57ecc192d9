"""Compares an exported policy with wayfield's own decisions.

The working directory contains `policy.onnx`, a file for each input of the policy, such as `ranges.f32`, and `q_values.f32`, the
Q-values that wayfield computes for these inputs. The `.f32` files are rows of little-endian f32 values.
"""

import json

import numpy as np
import onnx
import onnxruntime

path = "policy.onnx"
model = onnx.load(path)
onnx.checker.check_model(model, full_check=True)
onnx.shape_inference.infer_shapes(model, check_type=True, strict_mode=True, data_prop=True)
assert model.ir_version == 8 and [(o.domain, o.version) for o in model.opset_import] == [("", 17)]
metadata = {entry.key: entry.value for entry in model.metadata_props}
assert list(metadata) == ["wayfield"], metadata
card = json.loads(metadata["wayfield"])["card"]

session = onnxruntime.InferenceSession(path)
assert [output.name for output in session.get_outputs()] == ["q_values", "action", "velocity"]
inputs = {}
for tensor in session.get_inputs():
    rows, width = tensor.shape
    assert rows == "n" and tensor.type == "tensor(float)", tensor
    inputs[tensor.name] = np.fromfile(f"{tensor.name}.f32", "<f4").reshape(-1, width)
q_values, action, velocity = session.run(None, inputs)

expected = np.fromfile("q_values.f32", "<f4").reshape(len(q_values), -1)
assert (expected.std(axis=0) > 0.05).all(), "the Q-values hardly depend on the observation"
difference = np.abs(q_values - expected).max()
assert difference < 1e-4, f"the Q-values differ by {difference}"
assert action.dtype == np.int64 and action.shape == (len(q_values),)
assert (action == q_values.argmax(axis=1)).all(), "not the first of the best actions"
ordered = np.sort(expected, axis=1)
is_clear = ordered[:, -1] - ordered[:, -2] > 1e-4 if expected.shape[1] > 1 else np.ones(len(action), bool)
assert (action == expected.argmax(axis=1))[is_clear].all(), "another action where the best one is clear"
if "highest_motion" in inputs:
    fractions = np.array([[a["speed"], a["turn"]] for a in card["relative_actions"]], np.float32)[action]
    limits = np.where(fractions < 0, -inputs["lowest_motion"], inputs["highest_motion"])
    assert (velocity == fractions * limits).all(), "not the fractions of the robot's limits"
    assert (velocity < 0).any() and (velocity > 0).any(), "not all kinds of motions"
else:
    motions = np.array([[a["v_m_s"], a["w_rad_s"]] for a in card["actions"]], np.float32)
    assert (velocity == motions[action]).all(), "not the velocities of the action"

# One observation alone, in which a beam hits nothing: first with the maximum range, then infinite, as a real LIDAR reports it.
one = {name: rows[:1].copy() for name, rows in inputs.items()}
if "ranges" in one:
    one["ranges"][0, 0] = card["scenario"]["lidar"]["max_range_m"]
    limited = session.run(["q_values"], one)[0]
    one["ranges"][0, 0] = np.inf
    assert (session.run(["q_values"], one)[0] == limited).all(), "an infinite range does not count as the maximum range"

example = card["example"]
given = {
    "ranges": example["ranges_m"],
    "goal": [example["goal_bearing_rad"], example["goal_distance_m"]],
    "sensor_readings": example["sensor_readings"],
    "observation": example["observation"],
}
row = {name: np.array([given[name]], np.float32) if name in given else one[name] for name in inputs}
assert np.allclose(session.run(["q_values"], row)[0], [example["q_values"]], atol=1e-3), "the card's example"

print(json.dumps({"observations": len(action), "clear": int(is_clear.sum()), "difference": float(difference)}))
