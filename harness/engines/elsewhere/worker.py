"""The worker: one engine in this process, asked over standard input, answering on what was standard output.

Requests are ("about",), ("presets", route, preset, dt) and ("simulate", task); answers ("done", value) or
("failed", HarnessError). It needs numpy, scipy, numba, platformdirs, the engine's own packages and, for MuJoCo and
PyBullet, lxml; everything of this package is read from the files of the process that started it.

What goes between a process and its worker: pickles, each after its length.
"""

import copyreg
import os
import pickle
import struct
import sys
from importlib import import_module
from pathlib import Path
from types import MappingProxyType
from typing import IO, Any

from harness.core.errors import HarnessError, SimulationError
from harness.engines.base import Engine

_LENGTH = struct.Struct("<Q")


def _view(settings: dict[str, Any]) -> MappingProxyType[str, Any]:
    return MappingProxyType(settings)


# settings are mappings that cannot be written to, which pickle does not know
copyreg.pickle(MappingProxyType, lambda settings: (_view, (dict(settings),)))


def send(stream: IO[bytes], message: Any) -> None:
    """Write one message; raises OSError when nobody reads any more, and what pickle raises."""
    data = pickle.dumps(message, protocol=5)
    stream.write(_LENGTH.pack(len(data)))
    stream.write(data)
    stream.flush()


def receive(stream: IO[bytes]) -> Any:
    """Read one message; raises EOFError when the other side has gone."""
    (length,) = _LENGTH.unpack(_exactly(stream, _LENGTH.size))
    return pickle.loads(_exactly(stream, length))


def _exactly(stream: IO[bytes], count: int) -> bytes:
    data = stream.read(count)
    if len(data) < count:
        raise EOFError("the other side has gone")
    return data


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
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what an engine prints must not get between the answers
    engine: Engine | None = None
    while True:
        try:
            asked = receive(sys.stdin.buffer)
            engine = engine or _made(where)
            send(answers, ("done", _answer(engine, *asked)))
        except EOFError:
            break
        except HarnessError as error:
            send(answers, ("failed", error))
        except (
            Exception
        ) as error:  # what an engine raises, or a law from a module that is not here, fails its run alone
            send(answers, ("failed", SimulationError(f"internal error, {type(error).__name__}: {error}")))
    answers.flush()
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
        place = Path(sys.prefix).name
        return engine.name, engine.version(), engine.routes, engine.native, place
    return engine.presets(*given) if what == "presets" else engine.simulate(*given)
