"""A case of the corpus: what is asked of the public API, what is right, and what an answer comes to."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

Answer = Mapping[str, Any]
"""A result as plain data, or {"error": text}."""
Mark = Literal["right", "listed", "wrong", "silent", "false alarm", "refused", "missed"]
SILENT = ("adequate", "unexplained", "error")
LONGEST_LIST = 4


@dataclass(frozen=True, slots=True)
class Truth:
    """What is right, in words and so that it can be checked.

    names : of which each must be claimed, or listed among at most four; quiet : that none may be. numbers : a value
    (path in the result, dots between) and by how much it may be off, as a share. read : that the file must be read.
    either : any one of ``names`` will do. verdict : one of these is right whatever is named.
    """

    said: str
    names: tuple[str, ...] = ()
    quiet: bool = False
    numbers: Mapping[str, tuple[float, float]] | None = None
    read: bool = False
    either: bool = False
    verdict: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Case:
    """One call. truth : None where nobody knows."""

    name: str
    kind: str
    ask: Callable[[], Any]
    truth: Truth | None = None
    own: bool = False


def _claimed(answer: Answer) -> tuple[set[str], set[str]]:
    """Names that an answer claims, and those that it lists as one of several."""
    if answer.get("verdict") in SILENT:
        return set(), set()
    found = answer.get("mechanisms", [])
    claimed = {m["name"] for m in found if m["grade"] in ("explains", "main")}
    return claimed, {m["name"] for m in found if m["grade"] == "one-of"}


def _at(answer: Any, path: str) -> Any:
    for key in path.split("."):
        if isinstance(answer, list):
            answer = answer[int(key)] if int(key) < len(answer) else None
        else:
            answer = answer.get(key) if isinstance(answer, Mapping) else None
    return answer.get("value") if isinstance(answer, Mapping) else answer


def marked(answer: Answer, truth: Truth | None) -> Mark | None:
    """What an answer is worth beside the truth, None where nobody knows it."""
    if truth is None:
        return None
    verdict = answer.get("verdict")
    if truth.verdict or verdict == "error":
        return "right" if verdict in truth.verdict else "wrong" if truth.verdict else "refused"
    for path, (value, off) in (truth.numbers or {}).items():
        found = _at(answer, path)
        if not isinstance(found, int | float) or abs(found - value) > off * abs(value):
            return "missed"
    claimed, listed = _claimed(answer)
    if truth.quiet:
        return "false alarm" if claimed or listed else "right"
    return _named(claimed, listed if len(listed) <= LONGEST_LIST else set(), truth) if truth.names else "right"


def _named(claimed: set[str], listed: set[str], truth: Truth) -> Mark:
    """What names are worth: all that are wanted, or any one, and none besides."""
    wanted, said = set(truth.names), claimed | listed
    if not said:
        return "silent"
    enough = (lambda names: bool(wanted & names)) if truth.either else (lambda names: wanted <= names)
    if not enough(said) or (claimed - wanted and not truth.either):
        return "wrong"
    return "right" if enough(claimed) else "listed"


def _digits(quantity: Any) -> str:
    if not isinstance(quantity, Mapping) or quantity.get("value") is None:
        return "none"
    error = quantity.get("stderr")
    return f"{quantity['value']:.3g}" + (f" +- {error:.1g}" if isinstance(error, int | float) else "")


def outcome(answer: Answer) -> dict[str, Any]:
    """What is kept of an answer: outcomes alone, numbers to three digits."""
    if answer.get("verdict") == "error":
        return {"verdict": "error", "error": str(answer["error"]).split(";")[0][-120:]}
    kept: dict[str, Any] = {"verdict": answer.get("verdict", "done")}
    named = answer.get("mechanisms")
    if named:
        kept["names"] = {
            m["name"]: m["grade"] + ("" if m.get("share") is None else f" {m['share']:.2f}") for m in named
        }
        kept["parameters"] = {
            f"{m['name']}.{key}": _digits(value) for m in named for key, value in m["parameters"].items()
        }
    for part in ("refined", "aligned", "properties"):
        numbers = answer.get(part)
        numbers = numbers.get("parameters", numbers) if isinstance(numbers, Mapping) else None
        if isinstance(numbers, Mapping):
            said = {k: _digits(v) for k, v in numbers.items() if isinstance(v, Mapping) and "value" in v}
            kept.setdefault("parameters", {}).update({f"{part}.{k}": v for k, v in said.items()})
    for method, numbers in answer.get("estimates", {}).items():
        if isinstance(numbers, Mapping):
            said = {k: _digits(v) for k, v in numbers.items() if isinstance(v, Mapping) and "value" in v}
            kept.setdefault("parameters", {}).update({f"{method}.{k}": v for k, v in said.items()})
    for one in answer.get("as_it_is", []):
        creep = "none" if one["creep"] is None else f"{one['creep']:.3g}"
        kept.setdefault("parameters", {})[f"{one['engine']}.creep"] = creep if abs(one["creep"] or 1.0) > 1e-9 else "0"
    return kept
