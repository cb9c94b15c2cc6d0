"""Everything a Task asks for that MuJoCo has no attribute for, as the words the callback reads."""

from typing import Any

import numpy as np

from harness.core.arrays import FloatArray
from harness.core.errors import SimulationError
from harness.core.scenario import Harmonic, Hold
from harness.engines.actions import belt_speed, held_at_start
from harness.engines.base import Task
from harness.engines.mujoco.callback import SLOTS, Slot

_STAGES = {"RK4": 4}


class Forces:
    """Words of userdata for one run, and the memory they point to; keep it until the run is over.

    needed : whether the callback has to be installed at all. first_limit : friction limit at the start, N.
    applied, limits : what the callback recorded, one word a step.
    """

    def __init__(self, task: Task, settings: dict[str, Any]) -> None:
        scenario, law = task.scenario, task.law
        slider, action = scenario.slider, scenario.action
        contact = task.route == "contact"
        if contact and law is not None and law.level is not None:
            raise SimulationError("mujoco: on the contact route the level of friction is a constant coefficient")
        steps = task.steps(settings["dt"])
        self.applied: FloatArray = np.zeros(steps + 1)
        self.limits: FloatArray = np.full(steps + 1, slider.f_k)
        # on a belt the joint lives in the frame of the belt, where its friction belongs; the spring's end moves instead
        self.frame = 0.0 if contact else belt_speed(task)
        self.stages = _STAGES.get(settings["integrator"], 1)
        self.state = np.zeros(0) if law is None else law.state.copy()
        self.ratio = slider.break_away / slider.f_k if slider.f_k > 0.0 else 1.0
        self.excess = slider.break_away if slider.f_k == 0.0 else 0.0
        self._kept: list[FloatArray] = []
        words = np.zeros(SLOTS)
        k = slider.k if task.restoring == "spring" else 0.0
        words[Slot.STAGES] = self.stages
        words[Slot.DT] = settings["dt"]
        words[Slot.FRAME], words[Slot.STIFFNESS], words[Slot.DAMPING] = self.frame, k, slider.c
        words[Slot.PENDULUM] = slider.k if task.restoring == "pendulum" else 0.0
        match action:
            case Harmonic():
                words[[Slot.AMPLITUDE, Slot.OMEGA, Slot.PHASE]] = action.amplitude, action.omega, action.phase
            case Hold():
                words[Slot.CONSTANT] = action.force
        if task.drive is not None:
            words[Slot.DRIVE_N] = task.drive.t.size
            words[Slot.DRIVE_T], words[Slot.DRIVE_U] = self._keep(task.drive.t), self._keep(task.drive.u)
        if law is not None:
            from harness.engines.mujoco.native import advance_address, law_address

            words[Slot.FORCE] = law_address(law.force) if law.force else 0.0
            words[Slot.LEVEL] = law_address(law.level) if law.level else 0.0
            words[Slot.ADVANCE] = advance_address(law.advance) if law.advance else 0.0
            words[Slot.STATE], words[Slot.STATE_N] = self._keep(self.state), self.state.size
            words[Slot.PARAMS], words[Slot.PARAMS_N] = self._keep(law.params), law.params.size
        words[Slot.F_K], words[Slot.RATIO], words[Slot.EXCESS] = slider.f_k, self.ratio, self.excess
        words[Slot.CLIPPED] = task.route == "law"
        words[Slot.METRIC] = self._metric(task, settings["integrator"], settings["dt"])
        words[Slot.APPLIED], words[Slot.LIMITS] = self._keep(self.applied), self._keep(self.limits)
        words[Slot.RECORDS] = steps + 1
        self.switches = slider.break_away > slider.f_k
        own_level = law is not None and law.level is not None
        words[Slot.SETS_LEVEL] = task.route == "joint" and (self.switches or own_level)
        stuck = self.switches and held_at_start(task)
        words[Slot.STUCK] = stuck and not contact
        self.words = words
        self.first_limit = slider.break_away if stuck or slider.f_k == 0.0 else slider.f_k
        if own_level and self.first_limit == 0.0:
            self.first_limit = 1.0  # without any limit the joint has no row of friction to set
        if contact:
            words[Slot.F_K] = slider.f_k
        self.needed = bool(
            task.route == "law" or law is not None or task.drive is not None or self.frame or words[Slot.SETS_LEVEL]
            or task.restoring == "pendulum" or isinstance(action, Harmonic | Hold)
        )  # fmt: skip

    def _keep(self, array: FloatArray) -> float:
        self._kept.append(array)
        return float(array.ctypes.data)

    @staticmethod
    def _metric(task: Task, integrator: str, dt: float) -> float:
        """Force that stops unit speed in one step, kg/s: (m + dt c)/dt where damping is implicit.

        The spring that `discrete` treats implicitly cancels: stopped, the slider does not stretch it further.
        """
        slider = task.scenario.slider
        return slider.m / dt + (0.0 if integrator == "RK4" else slider.c)
