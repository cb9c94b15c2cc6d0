"""What ends an error: a whole command to paste in place of the one that failed."""

import os
import re
import shlex
import tempfile
from collections.abc import Sequence
from difflib import SequenceMatcher
from pathlib import Path

import click

from harness.cli.output import this_line
from harness.core.errors import HarnessError, InputError

_PROPOSED = re.compile(r"Try: (?P<options>-{1,2}[a-z].*?)(?P<rest>, which reads .*)?$")
_NEAR = re.compile(r"; did you mean (?P<name>.+)\?$")
_PARTS = re.compile(r"([@=,:])")
_LISTED = re.compile(r"; expected (?:a joint|a body|a movable body) of [^;]*?: (?P<first>[\w.-]+)")
"""What says the names that there are."""
_WRITES = {"--out", "--json", "--junit", "--page", "--save"}
"""Options whose value is a place that may not do."""
_UPDATED, _UPDATE = "--baseline", "--update"
"""One whose value is read, and written where the other is given: it is not left out, it gets another place."""
_READS = {"--columns", "--covariate"}
"""Options that name a column."""
_CHOICES = re.compile(r"(?:one of )?([a-z][\w-]*(?:, [a-z][\w-]*)+)")
"""A list of what an argument may be."""
_COMMON = "mujoco"
"""The one of a list that every installation has."""
_LEAVE_OUT = re.compile(r"given with (?P<option>--[a-z-]+); .*; leave it out$|, or no (?P<other>--[a-z-]+)$")
"""What says which of two options goes."""
_ALIKE = 0.6
"""As difflib's own cutoff, by which the near name was found."""


def whole_line(error: Exception, group: click.Group) -> str:
    """The message, and the command that was meant, where the message says what is to be changed in the one given.

    error : ends in options to try, in a name that is near, or is about an option that does not go with the others; one
    of click's names its command. group : whose commands know which options take a value.
    """
    words = shlex.split(this_line())
    if isinstance(error, click.UsageError):
        message = error.format_message()
        help_of = error.ctx.command_path if error.ctx else f"harness {words[1]}" if words[1:] else "harness"
    else:
        message, help_of = str(error), ""
    if isinstance(error, click.NoSuchOption) and (kept := _of_one_command(words, error.option_name, group)):
        return f"No such option '{error.option_name}' here. Try: {shlex.join(kept)}"
    near = error.possibilities[0] if isinstance(error, click.NoSuchOption) and error.possibilities else ""
    if found := _NEAR.search(message):
        near = found["name"]
    if words and (options := _PROPOSED.search(message)):
        line = f"{shlex.join(_without_named(words, options['options']))} {options['options']}"
        return f"{message[: options.start()]}Try: {line}{options['rest'] or ''}"
    about = error.where if isinstance(error, InputError) else ""
    if words and near and (meant := _with_near(words, near, about)):
        line = shlex.join(meant)
        if (folder := near.rpartition("/*"))[1]:  # a pattern that stands quoted names one file
            line = line.replace(shlex.quote(near), f"{shlex.quote(folder[0])}/*{folder[2]}")
        return f"{message.rstrip('.')}{'' if message.endswith('?') else '.'} Try: {line}"
    to_mend = len(words) > 1 and isinstance(error, HarnessError) and "Try: " not in message
    if to_mend and (kept := _mended(words, error, group)):
        return f"{message.rstrip('.')}. Try: {shlex.join(kept)}"
    return f"{message.rstrip('.')}. Try: {help_of} --help" if help_of else message


def _of_one_command(words: Sequence[str], name: str, group: click.Group) -> list[str]:
    """Words of a command that has all options that they give, by the fewest changes: without the one that only other
    commands have, and its value, or of several the same for a command that has them and takes such arguments; none
    where no command has ``name``.
    """
    context = click.Context(group)
    found = {one: group.get_command(context, one) for one in group.list_commands(context)}
    parameters = {one: command.params for one, command in found.items() if command}
    options = {one: {option: p for p in those for option in p.opts} for one, those in parameters.items()}
    own = options.get(words[1], {})
    given = {i: word.partition("=")[0] for i, word in enumerate(words) if word.startswith("--")}
    known = {word: one[word] for word in given.values() for one in options.values() if word in one}
    foreign = {i: known[word] for i, word in given.items() if word in known and word not in own}
    if name not in known:
        return []
    every = {word for word in given.values() if word in known}
    takes = {one: {type(p.type) for p in those if isinstance(p, click.Argument)} for one, those in parameters.items()}
    able = [one for one, has in options.items() if every <= has.keys() and takes[one] == takes.get(words[1])]
    if len(foreign) > 1 and able:
        return [words[0], able[0], *words[2:]]
    gone = set[int]()
    for i, option in foreign.items():
        valued = isinstance(option, click.Option) and not option.is_flag and "=" not in words[i]
        gone.update(range(i, i + 1 + valued * option.nargs))
    return [word for i, word in enumerate(words) if i not in gone]


def _without_named(words: Sequence[str], options: str) -> list[str]:
    """Words of a command without the options that others replace."""
    named = set(re.findall(r"(?<!\S)--?[a-z][a-z-]*", re.sub(r"\"[^\"]*\"", "", options)))
    valued = named - {"--drop-nan"}
    pairs = zip(["", *words], words, strict=False)
    return [word for before, word in pairs if before not in valued and not {word, word.partition("=")[0]} & named]


def _with_near(words: Sequence[str], name: str, about: str) -> list[str]:
    """Words of a command with ``name`` in place of the one the error is about, else of the one most like it; none where
    no word is like it.
    """
    if about in words[1:] and not about.startswith("-"):
        return [name if word == about else word for word in words]
    places = [(i, j, part) for i, word in enumerate(words) if i for j, part in enumerate(_split(word, name))]
    alike = [(_likeness(part, name), i, j) for i, j, part in places if part != name]
    ratio, i, j = max(alike, default=(0.0, 0, 0))
    if ratio < _ALIKE:
        return []
    parts = _split(words[i], name)
    parts[j] = name
    return [*words[:i], "".join(parts), *words[i + 1 :]]


def _likeness(part: str, name: str) -> float:
    """From 0 to 1; of a folder and a file in it 1. That both are options makes them no more alike."""
    if name.startswith(f"{part.rstrip('/')}/"):
        return 1.0
    return SequenceMatcher(None, part.lower().lstrip("-"), name.lstrip("-")).ratio()


def _split(word: str, name: str) -> list[str]:
    """A word in the parts that a name may be one of; a path stays whole."""
    return [word] if _PARTS.search(name) else _PARTS.split(word)


def _mended(words: Sequence[str], error: Exception, group: click.Group) -> list[str]:
    """Words of a command with another value for the option that an error is about, where it lists some, or without it;
    none where it is about nothing that can be left out.
    """
    command = group.get_command(click.Context(group), words[1])
    options = [one for one in command.params if isinstance(one, click.Option)] if command else []
    wrong: list[tuple[int, click.Option]] = []
    filled: list[tuple[int, click.Option]] = []
    for option in options:
        at = [i for i, word in enumerate(words) if word.partition("=")[0] in option.opts]
        value = "".join(words[at[0]].partition("=")[2] or words[at[0] + 1 : at[0] + 2]) if at else ""
        if at and _is_about(error, option, value):
            if option.required or len(at) > 1:
                return []
            wrong.append((at[0], option))
        elif value and "--out" in option.opts and Path(value).is_dir() and any(Path(value).iterdir()):
            filled = [(at[0], option)]
    # what went into --out before another place would not do is there, and it takes no second result
    wrong += filled if any(not _WRITES.isdisjoint(option.opts) for _, option in wrong) else []
    listed, kept = _LISTED.search(str(error)), list(words)
    if not wrong and isinstance(error, InputError) and (listing := _CHOICES.fullmatch(error.accepted)):
        choices = listing[1].split(", ")
        first = _COMMON if _COMMON in choices else choices[0]
        return [first if error.found == f"'{word}'" else word for word in words] if error.found[1:-1] in words else []
    # of two that exclude each other the first stays
    for i, option in sorted(wrong, reverse=True)[: 1 if "; expected one of the two" in str(error) else None]:
        count = 0 if option.is_flag or "=" in words[i] else option.nargs
        kept[i : i + 1 + count] = [words[i], listed["first"]] if listed and count == 1 else []
        if _UPDATED in option.opts and _UPDATE in words:
            kept[i:i] = [_UPDATED, _elsewhere(words[i].partition("=")[2] or words[i + 1])]
    return kept if wrong else []


def _elsewhere(place: str) -> str:
    """A file of that name, in JSON, in the folder of the command, or in that of temporary files."""
    name = Path(place).with_suffix(".json").name
    here = os.access(".", os.W_OK) and not Path(name).exists()
    return name if here else str(Path(tempfile.gettempdir()) / name)


def _is_about(error: Exception, option: click.Option, value: str) -> bool:
    """Whether an error names an option that was given, the number that it sets, a column that it takes, or the place
    that it writes to; not what is wrong with a file that it reads.
    """
    where, _, found = str(error).partition(": ")
    if isinstance(error, InputError):
        where, found = error.where, error.found
        if beside := _LEAVE_OUT.search(str(error)):
            return (beside["option"] or beside["other"]) in option.opts
    writes = not _WRITES.isdisjoint(option.opts) or (_UPDATED in option.opts and _UPDATE in shlex.split(this_line()))
    if writes and value == "-":
        return False
    if writes and value and (where == value or Path(where).is_relative_to(Path(value).absolute())):
        return True
    if isinstance(option.type, click.Path) and not writes and not found.startswith("given"):
        return False
    if not _READS.isdisjoint(option.opts) and found == "no such column":
        return True
    named = re.findall(r"--[a-z][\w-]*", found if "between --" in found and "--" not in where else where)
    return not set(named).isdisjoint(option.opts) or where.rpartition(": ")[2] == option.name
