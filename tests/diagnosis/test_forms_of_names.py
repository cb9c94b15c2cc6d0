"""One effect in another form than the catalogue's stays one name."""

import numpy as np
import pytest
from scipy.linalg import expm

import harness
from harness.core.arrays import FloatArray
from harness.core.recording import Recording
from harness.kernels.solve import solve
from harness.model.model import Model, ModelTerm

T = np.linspace(0.0, 6.0, 361)


def seen(x: FloatArray, noise: float) -> Recording:
    return Recording(T, {"x": x + noise * np.random.default_rng(5).standard_normal(T.size)})


def names(recording: Recording) -> list[str]:
    found = harness.diagnose(recording, restoring="spring", zero="spring", engines=())
    return [] if found.verdict != "missing_physics" else [one.name for one in found.mechanisms]


@pytest.mark.parametrize(("gap", "name"), [(0.05, "backlash"), (0.75, "end-stop")])
def test_what_stiffens_on_both_sides_is_play_from_near_the_middle_on_and_a_stop_near_the_ends(
    gap: float, name: str
) -> None:
    stop = ModelTerm.named("end-stop", gap=gap, k_stop=30.0)
    machine = Model(m=1.0, c=0.15, k=60.0, f_k=0.3, x0=1.0, terms=(stop,), mass_known=False)
    assert names(seen(solve(machine, T).x, 1e-4)) == [name]


def test_a_spring_that_relaxes_at_once_and_slowly_is_one_viscoelastic_spring() -> None:
    """Three branches of other stiffness each, without friction: a linear machine, by its matrix."""
    arms = ((3.0, 0.03), (2.0, 0.1), (1.5, 0.5))
    a = np.zeros((5, 5))
    a[0, 1], a[1, :2] = 1.0, (-60.0, -0.15)
    for i, (stiff, time) in enumerate(arms, 2):
        a[1, i], a[i, 1], a[i, i] = -stiff, 1.0, -1.0 / time
    state, step, x = np.array([1.0, 0.0, 0.0, 0.0, 0.0]), expm(a * T[1]), list[float]()
    for _ in T:
        x.append(float(state[0]))
        state = step @ state
    assert names(seen(np.array(x), 1e-5)) == ["viscoelastic"]
