"""Cross-validation of dry friction in physics engines; the names below do for programs what the command does.

They are loaded when they are first used: importing the package itself costs nothing.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from harness import stages
    from harness.api import (
        TERMS,
        JointLog,
        Model,
        ModelTerm,
        Recording,
        Slot,
        Term,
        change,
        compare,
        compare_models,
        diagnose,
        diagnose_joint,
        diagnose_servo,
        diff,
        identify,
        load,
        load_log,
        log,
        motion,
        plan,
        prove,
        regress,
        run,
        run_joint,
        run_scene,
        simulate,
        sweep,
        tune,
        verify_proof,
        words,
    )
    from harness.core import __version__
else:
    # out of sight of type checkers, which would take any name for granted
    def __getattr__(name: str) -> Any:
        if name not in __all__:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        if name == "stages":
            return import_module("harness.stages")
        if name == "__version__":
            return import_module("harness.core").__version__
        return getattr(import_module("harness.api"), name)


__all__ = [
    "TERMS",
    "JointLog",
    "Model",
    "ModelTerm",
    "Recording",
    "Slot",
    "Term",
    "__version__",
    "change",
    "compare",
    "compare_models",
    "diagnose",
    "diagnose_joint",
    "diagnose_servo",
    "diff",
    "identify",
    "load",
    "load_log",
    "log",
    "motion",
    "plan",
    "prove",
    "regress",
    "run",
    "run_joint",
    "run_scene",
    "simulate",
    "stages",
    "sweep",
    "tune",
    "verify_proof",
    "words",
]


def __dir__() -> list[str]:
    return list(__all__)
