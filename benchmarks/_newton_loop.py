"""A bare loop of Newton, for an interpreter that has it: one run of the paper's decay for every line it reads.

As newton@PYTHON steps when tuned, at 1e-3 s for 3 s, model and solver made anew in every run; needs nothing of ours.
"""

import sys

import newton
import numpy as np
import warp

M, C, K, F, X0, DT, STEPS = 1.0, 1.0, 100.0, 3.0, 1.0, 1e-3, 3001
SCALE = M / (M + 0.5 * DT * C)
IMPEDANCE = 0.9999


def loop() -> object:
    kind = newton.solvers.SolverMuJoCo
    builder = newton.ModelBuilder(gravity=(0.0, 0.0, 0.0))
    kind.register_custom_attributes(builder)
    words = {
        "mujoco:solreffriction": [(-1.0, -1.9 * IMPEDANCE / DT)],
        "mujoco:solimpfriction": [(IMPEDANCE, IMPEDANCE, 0.001, 0.5, 2.0)],
    }
    link = builder.add_link(mass=M, inertia=warp.mat33(np.eye(3)))
    joint = builder.add_joint_prismatic(-1, link, axis=(1.0, 0.0, 0.0), friction=SCALE * F, custom_attributes=words)
    builder.add_articulation([joint])
    builder.joint_q[-1] = X0
    model = builder.finalize(device="cpu")
    solver = kind(model, use_mujoco_cpu=True, integrator="euler")
    now, then, control = model.state(), model.state(), model.control()
    newton.eval_fk(model, model.joint_q, model.joint_qd, now)
    force = np.zeros(1, dtype=np.float32)
    x, v, a = np.empty((3, STEPS))
    q, speed = X0, 0.0
    for i in range(STEPS):
        before = speed
        x[i], v[i] = q, before
        force[0] = SCALE * (-K * q - C * before)
        control.joint_f.assign(force)
        now.clear_forces()
        solver.step(now, then, control, None, DT)
        now, then = then, now
        q, speed = now.joint_q.numpy().item(), now.joint_qd.numpy().item()
        a[i] = (speed - before) / DT
    return x, v, a


if __name__ == "__main__":
    for _ in sys.stdin:
        loop()
        print("done", flush=True)
