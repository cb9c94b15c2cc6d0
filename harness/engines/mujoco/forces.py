"""Everything a Task asks for that MuJoCo has no attribute for, as the words the callback reads."""

from typing import Any

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.core.scenario import Harmonic, Hold
from harness.engines.actions import belt_speed, held_at_start
from harness.engines.base import Task
from harness.engines.law import ForceLaw
from harness.engines.mujoco.callback import SLOTS, Slot

_STAGES = {"RK4": 4}


class Forces:
    """Words of userdata for one run, and the memory they point to; keep it until the run is over.

    words : float64, shape (SLOTS,). needed : whether the callback has to be installed at all. frame : speed of the
    frame the joint lives in, m/s. switches : whether break-away lies above sliding friction. first_limit : friction
    limit at the start, N. applied, limits : what the callback records, one word a step, shape (steps + 1,).

    Raises SimulationError for a level of friction that depends on the state on the contact route.
    """

    def __init__(self, task: Task, settings: dict[str, Any]) -> None:
        slider, law, contact = task.scenario.slider, task.law, task.route == "contact"
        own_level = law is not None and law.level is not None
        if contact and own_level:
            raise SimulationError("mujoco: on the contact route the level of friction is a constant coefficient")
        count = task.steps(settings["dt"]) + 1
        self._kept: list[FloatArray] = []
        self.applied: FloatArray = np.zeros(count)
        self.limits: FloatArray = np.full(count, slider.f_k)
        # on a belt the joint lives in the frame of the belt, where its friction belongs; the spring's end moves instead
        self.frame = 0.0 if contact else belt_speed(task)
        self.switches = slider.break_away > slider.f_k
        stuck = self.switches and held_at_start(task, settings["dt"])
        self.first_limit = slider.break_away if stuck or slider.f_k == 0.0 else slider.f_k
        if own_level and self.first_limit == 0.0:
            self.first_limit = 1.0  # without any limit the joint has no row of friction to set

        words = np.zeros(SLOTS)
        words[Slot.STAGES], words[Slot.DT] = _STAGES.get(settings["integrator"], 1), settings["dt"]
        words[Slot.FRAME], words[Slot.DAMPING] = self.frame, slider.c
        words[Slot.STIFFNESS] = slider.k if task.restoring == "spring" else 0.0
        words[Slot.PENDULUM] = slider.k if task.restoring == "pendulum" else 0.0
        words[Slot.F_K] = slider.f_k
        words[Slot.RATIO] = slider.break_away / slider.f_k if slider.f_k > 0.0 else 1.0
        words[Slot.EXCESS] = slider.break_away if slider.f_k == 0.0 else 0.0
        words[Slot.SETS_LEVEL] = task.route == "joint" and (self.switches or own_level)
        words[Slot.STUCK] = stuck and not contact
        words[Slot.CLIPPED] = task.route == "law"
        words[Slot.METRIC] = slider.m / settings["dt"] + (0.0 if settings["integrator"] == "RK4" else slider.c)
        words[Slot.APPLIED], words[Slot.LIMITS] = self._keep(self.applied), self._keep(self.limits)
        words[Slot.RECORDS] = count
        self.words = words
        self._drive(task)
        if law is not None:
            self._law(law)
        unforced = task.scenario.action is None and task.drive is None and law is None and self.frame == 0.0
        plain = task.restoring != "pendulum" and not words[Slot.CLIPPED] and not words[Slot.SETS_LEVEL]
        self.needed = not (unforced and plain)

    def _drive(self, task: Task) -> None:
        match task.scenario.action:
            case Harmonic() as action:
                self.words[[Slot.AMPLITUDE, Slot.OMEGA, Slot.PHASE]] = action.amplitude, action.omega, action.phase
            case Hold() as action:
                self.words[Slot.CONSTANT] = action.force
        if task.drive is not None:
            self.words[Slot.DRIVE_N] = task.drive.t.size
            self.words[[Slot.DRIVE_T, Slot.DRIVE_U]] = self._keep(task.drive.t), self._keep(task.drive.u)

    def _law(self, law: ForceLaw) -> None:
        from harness.engines.mujoco.native import advance_address, law_address

        state = law.state.copy()
        self.words[Slot.FORCE] = law_address(law.force) if law.force else 0.0
        self.words[Slot.LEVEL] = law_address(law.level) if law.level else 0.0
        self.words[Slot.ADVANCE] = advance_address(law.advance) if law.advance else 0.0
        self.words[[Slot.STATE, Slot.STATE_N]] = self._keep(state), state.size
        self.words[[Slot.PARAMS, Slot.PARAMS_N]] = self._keep(law.params), law.params.size

    def _keep(self, array: FloatArray) -> float:
        """Address of an array, which is kept alive; exact as a double."""
        self._kept.append(array)
        return float(array.ctypes.data)
