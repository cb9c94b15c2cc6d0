"""What ends an error: a whole command to paste in place of the one that failed."""

import re
import shlex
from collections.abc import Sequence
from difflib import SequenceMatcher

import click

from harness.cli.output import this_line
from harness.core.errors import InputError

_PROPOSED = re.compile(r"Try: (?P<options>--.+?)(?P<rest>, which reads .*)?$")
_NEAR = re.compile(r"; did you mean (?P<name>.+)\?$")
_PARTS = re.compile(r"([@=,:])")
_ALIKE = 0.6
"""As difflib's own cutoff, by which the near name was found."""


def whole_line(error: Exception, group: click.Group) -> str:
    """The message, and the command that was meant, where the message says what is to be changed in the one given.

    error : ends in options to try, in a name that is near, or is about an option that does not go with the others; one
    of click's names its command. group : whose commands know which options take a value.
    """
    if isinstance(error, click.UsageError):
        message, help_of = error.format_message(), error.ctx.command_path if error.ctx else ""
    else:
        message, help_of = str(error), ""
    near = error.possibilities[0] if isinstance(error, click.NoSuchOption) and error.possibilities else ""
    if found := _NEAR.search(message):
        near = found["name"]
    words = shlex.split(this_line())
    if words and (options := _PROPOSED.search(message)):
        line = f"{shlex.join(_without_named(words, options['options']))} {options['options']}"
        return f"{message[: options.start()]}Try: {line}{options['rest'] or ''}"
    if words and near and (meant := _with_near(words, near)):
        return f"{message.rstrip('.')}{'' if message.endswith('?') else '.'} Try: {shlex.join(meant)}"
    if words and isinstance(error, InputError) and (kept := _without(words, error, group)):
        return f"{message}. Try: {shlex.join(kept)}"
    return f"{message.rstrip('.')}. Try: {help_of} --help" if help_of else message


def _without_named(words: Sequence[str], options: str) -> list[str]:
    """Words of a command without the options that others replace."""
    named = set(re.findall(r"--[a-z-]+", re.sub(r"\"[^\"]*\"", "", options)))
    valued = named - {"--drop-nan"}
    pairs = zip(["", *words], words, strict=False)
    return [word for before, word in pairs if before not in valued and not {word, word.partition("=")[0]} & named]


def _with_near(words: Sequence[str], name: str) -> list[str]:
    """Words of a command with ``name`` in place of the one most like it; none where no word is like it."""
    places = [(i, j, part) for i, word in enumerate(words) if i for j, part in enumerate(_split(word, name))]
    alike = [(_likeness(part, name), i, j) for i, j, part in places if part != name]
    ratio, i, j = max(alike, default=(0.0, 0, 0))
    if ratio < _ALIKE:
        return []
    parts = _split(words[i], name)
    parts[j] = name
    return [*words[:i], "".join(parts), *words[i + 1 :]]


def _likeness(part: str, name: str) -> float:
    """From 0 to 1; of a folder and a file in it 1."""
    return 1.0 if name.startswith(f"{part.rstrip('/')}/") else SequenceMatcher(None, part.lower(), name).ratio()


def _split(word: str, name: str) -> list[str]:
    """A word in the parts that a name may be one of; a path stays whole."""
    return [word] if _PARTS.search(name) else _PARTS.split(word)


def _without(words: Sequence[str], error: InputError, group: click.Group) -> list[str]:
    """Words of a command without the option that was given where it does not go; none where it is not about one."""
    at = [i for i, word in enumerate(words) if word.partition("=")[0] == error.where]
    goes_not = error.found.startswith("given") and error.accepted.startswith(("it ", "one of the two"))
    if len(at) != 1 or not goes_not or len(words) < 2:
        return []
    command = group.get_command(click.Context(group), words[1])
    options = [one for one in command.params if error.where in one.opts] if command else []
    if not options or not isinstance(options[0], click.Option):
        return []
    values = 0 if options[0].is_flag or "=" in words[at[0]] else options[0].nargs
    return [*words[: at[0]], *words[at[0] + 1 + values :]]
