"""A pendulum's free decay: the estimators under --restoring pendulum, and the run of one."""

import re
from pathlib import Path

import numpy as np
import pytest

from harness.app.identify import result_of
from harness.app.run.run import RunOptions, run
from harness.app.shared.estimates import estimate
from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.kernels.solve import solve
from harness.model.model import Model, Restoring

OMEGA, ZETA, X_K = 6.0, 0.01, 0.01
TRUE = {"omega_n": OMEGA, "zeta": ZETA, "x_k": X_K}


def swing(x0: float, seed: int | None, span: float = 14.0) -> Recording:
    """A decay from x0 (rad), with noise of 1 mrad and .05 rad/s^2 unless ``seed`` is None."""
    model = Model(
        1.0, 2.0 * ZETA * OMEGA, OMEGA**2, X_K * OMEGA**2, x0=x0, restoring=Restoring.PENDULUM, mass_known=False
    )
    t = np.arange(0.0, span, 4e-3)
    motion = solve(model, t)
    random = np.random.default_rng(seed or 0)
    level = 0.0 if seed is None else 1.0
    x = motion.x + level * 1e-3 * random.standard_normal(t.size)
    a = motion.a + level * 0.05 * random.standard_normal(t.size)
    return Recording(t, {"x": x, "a": a}, "swing.csv", angular=True)


@pytest.mark.parametrize("x0", [0.5, 1.5])
def test_estimates_of_a_pendulum_are_within_their_errors(x0: float) -> None:
    found = estimate(swing(x0, 3), "pendulum")
    for method in ("acceleration", "displacement"):
        for name, true in TRUE.items():
            figure = getattr(found.methods[method], name)
            assert abs(figure.value - true) < 5.0 * figure.stderr, (method, name, figure)
            assert figure.value == pytest.approx(true, rel=0.02)


@pytest.mark.parametrize("x0", [0.5, 1.0, 1.5])
def test_the_systematic_error_is_below_a_tenth_of_a_standard_error(x0: float) -> None:
    """Without noise what is left is systematic; held against the error with noise."""
    clean, noisy = estimate(swing(x0, None), "pendulum"), estimate(swing(x0, 3), "pendulum")
    for method in ("acceleration", "displacement"):
        for name, true in TRUE.items():
            error = getattr(noisy.methods[method], name).stderr
            assert abs(getattr(clean.methods[method], name).value - true) < 0.1 * error, (method, name)


def test_a_spring_is_no_pendulum() -> None:
    """Read as a spring's, a swing of 1.5 rad gives a wrong frequency and wrong damping."""
    found = estimate(swing(1.5, 3)).methods["displacement"]
    assert abs((found.omega_n.value or 0.0) / OMEGA - 1.0) > 0.01
    assert abs((found.zeta.value or 0.0) / ZETA - 1.0) > 0.1


def test_an_angle_is_asked_for_and_the_result_says_how_it_was_read() -> None:
    plain = swing(0.5, 3)
    with pytest.raises(InputError, match="holds no angle"):
        estimate(Recording(plain.t, plain.channels, "cart.csv"), "pendulum")
    result, _ = result_of(plain, restoring="pendulum")
    assert result.restoring == "pendulum"
    assert result.estimates["displacement"].x_k.unit == "rad"
    assert any(line.startswith("Read as a pendulum") for line in result.warnings)


def test_a_pendulum_is_run_with_exact_events_and_in_radians(tmp_path: Path) -> None:
    options = RunOptions.asked(restoring="pendulum", given={"x0": 1.2}, engines=("mujoco",), preset="tuned")
    result = run(options, tmp_path / "out")
    exact, engine = result.traces
    for trace, within in ((exact, 1e-3), (engine, 5e-3)):
        figure = trace.estimates["acceleration"]
        assert figure.x_k.unit == "rad"
        assert figure.x_k.value == pytest.approx(0.03, rel=within)
        assert figure.zeta.value == pytest.approx(0.05, rel=within)
    assert Path(result.files["mjcf"]).name == "pendulum.xml"
    assert Path(result.files["mjcf"]).is_file()
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    words = re.sub(r"<script.*?</script>", "", page, flags=re.DOTALL)
    assert not re.search(r"[\d ]mm\b|>mm(/s)?<|N/m\b", words), "the page of an angle speaks of no length"
    assert "mrad" in words
    assert "N m/rad" in words
    assert "closed form" not in words
