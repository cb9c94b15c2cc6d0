"""What goes between a process and its worker: pickles, each after its length."""

import copyreg
import pickle
import struct
from types import MappingProxyType
from typing import IO, Any

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
