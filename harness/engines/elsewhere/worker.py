"""The worker: one engine in this process, asked over standard input, answering on what was standard output.

Requests are ("about",), ("presets", route, preset, dt), ("simulate", task) and ("simulate_all", tasks); answers
("done", value) or ("failed", HarnessError). It needs numpy, scipy, numba, platformdirs, the engine's own packages and,
for MuJoCo and PyBullet, lxml; everything of this package is read from the files of the process that started it.
"""

import copyreg
import os
import sys
from importlib import import_module
from multiprocessing.connection import Connection
from pathlib import Path
from types import MappingProxyType
from typing import Any

from harness.core.errors import HarnessError, SimulationError
from harness.engines.base import Engine


def _view(settings: dict[str, Any]) -> MappingProxyType[str, Any]:
    return MappingProxyType(settings)


# settings are mappings that cannot be written to, which pickle does not know
copyreg.pickle(MappingProxyType, lambda settings: (_view, (dict(settings),)))


START = """
import importlib.util, sys
folder, engine = sys.argv[1:3]
spec = importlib.util.spec_from_file_location("harness", folder + "/__init__.py", submodule_search_locations=[folder])
sys.modules["harness"] = package = importlib.util.module_from_spec(spec)
spec.loader.exec_module(package)
from harness.engines.elsewhere.worker import serve
serve(engine)
"""
"""What the other interpreter is started with: this package by its folder, and nothing else that lies beside it."""


def serve(where: str) -> None:
    """Answer until nobody asks any more. ``where`` : the engine's class, "module:Class"."""
    questions: Connection[Any, Any] = Connection(os.dup(0), writable=False)
    answers: Connection[Any, Any] = Connection(os.dup(1), readable=False)
    os.dup2(2, 1)  # what an engine prints must not get between the answers
    engine: Engine | None = None
    while True:
        try:
            asked = questions.recv()
            engine = engine or _made(where)
            answers.send(("done", _answer(engine, *asked)))
        except EOFError:
            break
        except HarnessError as error:
            answers.send(("failed", error))
        # what an engine raises, or a law from a module that is not here, fails its run alone
        except Exception as error:
            answers.send(("failed", SimulationError(f"internal error, {type(error).__name__}: {error}")))
    os._exit(0)  # exit handlers of engines belong to nobody


def _made(where: str) -> Engine:
    module, _, name = where.partition(":")
    try:
        made = getattr(import_module(module), name)()
    except ImportError as error:
        raise SimulationError(f"not installed ({error})") from error
    if not isinstance(made, Engine):
        raise SimulationError(f"{where} is not a harness.engines.base.Engine")
    return made


def _answer(engine: Engine, what: str, *given: Any) -> Any:
    if what == "about":
        about = {name: getattr(engine, name) for name in ("routes", "native", "calls", "curves", "batches")}
        return engine.name, engine.version(), about | {"place": Path(sys.prefix).name}
    return getattr(engine, what)(*given)
