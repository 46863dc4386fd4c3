"""Bodies that one end holds, in MuJoCo: reads a question in JSON, answers in JSON.

Asked by the crate beside this file (`--mujoco PYTHON`), whose src/mujoco.rs says what a question holds. It needs the
package `mujoco` from PyPI. Height is z here; time is that of the thread's processor.
"""

import json
import sys
import time

import mujoco
import numpy as np

# As src/motion.rs has it: the part of the sag by which the end may move in the last frames.
STILL, STILL_FRAMES = 1e-4, 60

# Of runs that are to come to rest [s].
DAMPING = 0.1

MODEL = """
<mujoco>
  <option timestep="{frame}" integrator="discrete" iterations="2000" gravity="0 0 -9.81">
    <flag contact="disable"/>
  </option>
  <size memory="4G"/>
  <worldbody>
    <flexcomp name="body" dim="3" radius="0.0001" {shape}>
      <elasticity young="{youngs_modulus}" poisson="{poissons_ratio}" damping="{damping}"/>
      <contact selfcollide="none" contype="0" conaffinity="0"/>
      {pin}
    </flexcomp>
  </worldbody>
</mujoco>
"""


def text(numbers):
    return " ".join(repr(x) for x in np.asarray(numbers).ravel().tolist())


def build(question, damping):
    """The model, and the numbers of the vertices at its free end."""
    body = question["body"]
    if "cells" in body:
        # Points at corners and middles; cells of 27 nodes. The nodes that are held carry their part of the weight too:
        # 1/6 of a cell's length by Simpson's weights. MuJoCo shares the whole mass among the others.
        size, cells = body["size"], body["cells"]
        mass = body["density"] * size[0] * size[1] * size[2] * (1 - 1 / (6 * cells[0]))
        count = [2 * n + 1 for n in cells]
        spacing = [a / (n - 1) for a, n in zip(size, count)]
        shape = (
            f'type="grid" dof="quadratic" count="{text(count)}" cellcount="{text(cells)}" '
            f'spacing="{text(spacing)}" mass="{mass!r}"'
        )
        pin = f'<pin gridrange="0 0 0 0 {2 * cells[1]} {2 * cells[2]}"/>'
    else:
        # The same nodes and cells, with z upward.
        points = np.array(body["positions"])[:, [0, 2, 1]] * [1, -1, 1]
        shape = (
            f'type="direct" dof="full" mass="1" point="{text(points)}" element="{text(body["tetrahedra"])}"'
        )
        pin = f'<pin id="{text(body["held"])}"/>'
    numbers = {key: question[key] for key in ("frame", "youngs_modulus", "poissons_ratio")}
    model = mujoco.MjModel.from_xml_string(MODEL.format(shape=shape, pin=pin, damping=damping, **numbers))
    data = mujoco.MjData(model)
    if "cells" in body:
        mujoco.mj_forward(model, data)
        x = data.flexvert_xpos[:, 0]
        tip = np.where(x > x.max() - 1e-9)[0]
    else:
        # The masses of the nodes, one body each.
        for vertex, owner in enumerate(model.flex_vertbodyid):
            if owner > 0:
                model.body_inertia[owner] *= body["masses"][vertex] / model.body_mass[owner]
                model.body_mass[owner] = body["masses"][vertex]
        mujoco.mj_setConst(model, data)
        mujoco.mj_forward(model, data)
        tip = np.array(body["tip"])
    return model, data, tip


def run(question, damping, frames, enough):
    model, data, tip = build(question, damping)
    heights = [float(data.flexvert_xpos[tip, 2].mean())]
    milliseconds = []
    while len(milliseconds) < frames and not enough(heights):
        start = time.thread_time()
        mujoco.mj_step(model, data)
        milliseconds.append((time.thread_time() - start) * 1e3)
        heights.append(float(data.flexvert_xpos[tip, 2].mean()))
    nodes = int(model.flex_nodenum[0]) or int(model.flex_vertnum[0])
    return nodes, milliseconds, heights


def at_rest(heights):
    """The mean sag over the last frames, or None where the end still moves."""
    if len(heights) <= STILL_FRAMES:
        return None
    last = np.array(heights[-STILL_FRAMES:])
    sag = heights[0] - float(last.mean())
    return sag if last.max() - last.min() <= STILL * abs(sag) else None


def main():
    question = json.load(sys.stdin)
    nodes, milliseconds, heights = run(question, 0.0, question["frames"], lambda _: False)
    _, _, slow = run(question, DAMPING, question["rest_frames"], lambda heights: at_rest(heights) is not None)
    json.dump(
        {
            "version": mujoco.__version__,
            "nodes": nodes,
            "milliseconds": milliseconds,
            "heights": heights,
            "sag_at_rest": at_rest(slow),
        },
        sys.stdout,
    )


main()
