"""Rooms import each other in the directions docs/architecture.md states; heavy libraries stay where they belong."""

import ast
import functools
import runpy
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from harness.model.registry import TERMS

ROOT = Path(__file__).resolve().parents[1]
PACKAGE = ROOT / "harness"

NOTHING: frozenset[str] = frozenset()
MAY: dict[str, frozenset[str]] = {
    "core": NOTHING,
    "results": frozenset({"core"}),
    "model": frozenset({"core"}),
    "kernels": frozenset({"core", "model"}),
    "exact": frozenset({"core"}),
    "fit": frozenset({"core"}),
    "estimate": frozenset({"core", "fit"}),
    "engines": frozenset({"core", "model", "kernels"}),
    "fidelity": frozenset({"core", "results", "exact", "estimate", "engines.base"}),
    "diagnosis": frozenset({"core", "model", "kernels", "fit", "estimate"}),
    "robot": frozenset({"core", "model", "engines", "fit", "estimate", "diagnosis"}),
    "proof": frozenset({"core", "results"}),
    "io": frozenset({"core"}),
    "show": frozenset({"core", "results", "fidelity"}),
    "cli": frozenset({"app", "core", "results"}),
}
"""What each room may import besides itself; app may import every room but cli and fit."""
MAY["app"] = frozenset(MAY) - {"cli", "fit"}
OUTSIDE = {
    "api.py": frozenset({"app", "core", "model", "results", "suites"}),
    "suites.py": frozenset({"app", "core", "model", "results"}),
    "sysid.py": frozenset({"core", "results"}),
    "stages.py": frozenset({"api", "app", "core", "diagnosis", "suites"}),
    "__init__.py": frozenset({"api", "core", "stages"}),
    "__main__.py": frozenset({"cli"}),
}
"""Files beside the rooms, and what they may import."""
PLANT = "proof/plant"
"""The independent check of the diagnosis: it sees core and nothing else, not even the rest of its room."""

HEAVY = ("numba", "scipy", "mujoco", "pybullet", "rerun", "pydantic", "rich", "pint", "numpy", "pyarrow", "h5py")
FILES = sorted(PACKAGE.rglob("*.py"))


@functools.cache
def parsed(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


@functools.cache
def nodes(path: Path) -> tuple[ast.AST, ...]:
    """All of a file, walked once."""
    return tuple(ast.walk(parsed(path)))


@functools.cache
def imports(path: Path, deep: bool = True) -> tuple[str, ...]:
    """Every module ``path`` imports, under TYPE_CHECKING too; only those at import time unless ``deep``."""
    return tuple(_imports(path, deep))


def _imports(path: Path, deep: bool) -> Iterator[str]:
    for node in nodes(path) if deep else _at_import(parsed(path)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: a relative import"
            # from harness import results is an import of harness.results
            module = node.module or ""
            yield from (f"{module}.{alias.name}" for alias in node.names) if module == "harness" else iter((module,))


def _at_import(tree: ast.Module) -> Iterator[ast.AST]:
    """Nodes that run when the module is imported."""
    todo: list[ast.AST] = [tree]
    while todo:
        node = todo.pop()
        yield node
        for child in ast.iter_child_nodes(node):
            typing_only = isinstance(child, ast.If) and ast.unparse(child.test) == "TYPE_CHECKING"
            if not isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda) and not typing_only:
                todo.append(child)


def name(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def forbidden(path: Path) -> list[str]:
    """Modules of ours that a file imports and its room may not."""
    parts = path.relative_to(PACKAGE).parts
    ours = [module for module in imports(path) if module.startswith("harness.")]
    if len(parts) == 1:
        return [module for module in ours if module.split(".")[1] not in OUTSIDE.get(parts[0], NOTHING)]
    own = parts[0]
    plant = name(path).startswith(f"harness/{PLANT}")
    allowed = frozenset({"core", "proof.plant"}) if plant else MAY.get(own, NOTHING) | {own}
    return [module for module in ours if not way(module) & allowed]


def way(module: str) -> set[str]:
    """The room of a module, and every package in it on the way down, as dotted names."""
    inside = module.removeprefix("harness.").split(".")
    return {".".join(inside[:depth]) for depth in range(1, len(inside) + 1)}


def test_rooms_import_in_one_direction() -> None:
    assert [f"{name(path)} imports {module}" for path in FILES for module in forbidden(path)] == []


def packages(path: Path) -> set[str]:
    """Folders of ours, as dotted names, that a file imports from."""
    found = set()
    for module in imports(path):
        if module.startswith("harness."):
            file = ROOT.joinpath(*module.split("."))
            found.add(".".join((file if (file / "__init__.py").is_file() else file.parent).relative_to(ROOT).parts))
    return found


def arrows() -> dict[str, set[str]]:
    """Every folder with those it imports from; parent and child belong together and are left out."""
    found: dict[str, set[str]] = {}
    for path in FILES:
        own = ".".join(path.parent.relative_to(ROOT).parts)
        family = {to for to in packages(path) if f"{to}.".startswith(f"{own}.") or f"{own}.".startswith(f"{to}.")}
        found.setdefault(own, set()).update(packages(path) - family)
    return found


def test_no_arrow_is_allowed_that_nobody_uses() -> None:
    for room, allowed in MAY.items():
        used = {module.removeprefix("harness.") for path in (PACKAGE / room).rglob("*.py") for module in imports(path)}
        unused = {to for to in allowed if not any(f"{module}.".startswith(f"{to}.") for module in used)}
        assert not unused, f"{room} may import {unused}, and does not"


def circling(graph: dict[str, set[str]]) -> set[str]:
    """What is in a circle, or imports something that is."""
    while leaves := {own for own, others in graph.items() if not others & graph.keys()}:
        graph = {own: others for own, others in graph.items() if own not in leaves}
    return set(graph)


def test_packages_import_each_other_in_no_circle() -> None:
    assert circling({"a": {"b"}, "b": {"c"}, "c": {"b"}, "d": set()}) == {"a", "b", "c"}
    assert not circling(arrows())


def files(path: Path) -> set[Path]:
    """Files of ours that a file imports, wherever in it."""
    found = set()
    for node in nodes(path):
        module = node.module if isinstance(node, ast.ImportFrom) else None
        names = [alias.name for alias in node.names] if isinstance(node, ast.Import | ast.ImportFrom) else []
        for one in (f"{module}.{name}" if module else name for name in names):
            whole = ROOT.joinpath(*one.split("."))
            places = [file for place in (whole, whole.parent) for file in (Path(f"{place}.py"), place / "__init__.py")]
            found |= set([file for file in places if file.is_file()][:1])
    return found - {path}


def test_files_import_each_other_in_no_circle() -> None:
    assert not circling({name(path): {name(one) for one in files(path)} for path in FILES})


def test_every_room_is_in_the_document_and_the_other_way_round() -> None:
    text = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    rows = {
        line.split("|")[1].strip() for line in text.splitlines() if line.startswith("| ") and "room" not in line[:7]
    }
    assert rows == set(MAY)


def test_the_document_says_the_same_arrows() -> None:
    text = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    everything = {"nothing of ours": NOTHING, "everything but cli and fit": MAY["app"]}
    for room, allowed in MAY.items():
        (row,) = (line for line in text.splitlines() if line.startswith(f"| {room} |"))
        said = row.split("|")[3].strip()
        assert everything.get(said, frozenset(said.split(", "))) == allowed, room


def test_the_ways_are_those_of_the_code() -> None:
    ways = runpy.run_path(str(ROOT / "docs" / "ways.py"))
    made = ways["text"]()
    assert (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8") == made, "run python docs/ways.py"
    for package in ("diagnosis.prepare", "diagnosis.search", "fidelity", "estimate", "show.report"):
        assert f"**{package}**" in made


def importers(*roots: str) -> set[str]:
    """Files that import any of these packages, at any depth."""
    return {name(path) for path in FILES if set(roots) & {module.split(".")[0] for module in imports(path)}}


NAMED_BY_DESIGN = ("harness/model/terms/", "harness/kernels/dispatch.py", "harness/proof/")
"""The terms themselves, the generated dispatch, and the proof, whose plant has its own list of effects."""


def test_a_term_is_named_in_its_own_file_alone() -> None:
    own = {word for term in TERMS for word in (term.key, term.name)}
    found = []
    for path in FILES:
        if not name(path).startswith(NAMED_BY_DESIGN):
            constants = (n.value for n in nodes(path) if isinstance(n, ast.Constant))
            words = {value for value in constants if isinstance(value, str)}
            found += [f"{name(path)}: {word}" for word in sorted(words & own)]
    assert found == []


def test_what_is_installed_imports_nothing_that_is_not() -> None:
    assert importers("benchmarks", "tests") == set()


def test_one_file_alone_imports_rerun() -> None:
    assert importers("rerun") <= {"harness/show/trace.py"}


def test_engines_the_robot_and_the_proof_alone_import_engines() -> None:
    found = importers("mujoco", "pybullet", "dartpy")
    assert {file.split("/")[1] for file in found} <= {"engines", "proof", "robot"}


def test_kernels_are_compiled_in_one_place() -> None:
    found = {file for file in importers("numba") if not file.startswith("harness/engines/")}
    assert found == {"harness/core/jit.py"}


def test_the_command_imports_nothing_heavy() -> None:
    early = {
        m.split(".")[0] for path in FILES if name(path).startswith("harness/cli") for m in imports(path, deep=False)
    }
    assert early <= {"click", "harness", *sys.stdlib_module_names}


def test_help_of_every_command_loads_nothing_heavy() -> None:
    program = (
        "import sys\n"
        "from harness.cli.main import cli\n"
        "import click\n"
        "ctx = click.Context(cli)\n"
        "for name in cli.list_commands(ctx):\n"
        "    command = cli.get_command(ctx, name)\n"
        "    assert command is not None\n"
        "    text = command.get_help(click.Context(command, info_name=f'harness {name}'))\n"
        "    assert 'Example: harness ' + name in text, name\n"
        f"print(sorted(set({HEAVY!r}) & set(sys.modules)))\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=ROOT, check=False)
    assert (done.stdout, done.stderr) == ("[]\n", "")


def bound(node: ast.stmt) -> set[str]:
    """Names that a statement of a module gives a meaning; an overload is a signature of the meaning that follows."""
    if isinstance(node, ast.FunctionDef) and any(ast.unparse(one) == "overload" for one in node.decorator_list):
        return set()
    if isinstance(node, ast.FunctionDef | ast.ClassDef):
        return {node.name}
    targets = node.targets if isinstance(node, ast.Assign) else [node.target] if isinstance(node, ast.AnnAssign) else []
    bare = [one for target in targets for one in (target.elts if isinstance(target, ast.Tuple) else [target])]
    return {one.id for one in bare if isinstance(one, ast.Name)}


def test_no_name_of_a_file_is_given_two_meanings() -> None:
    """Where two files become one, the later constant would silently serve both."""
    found = []
    for path in [*FILES, *sorted((ROOT / "tests").rglob("*.py")), *sorted((ROOT / "benchmarks").rglob("*.py"))]:
        names = Counter(one for node in parsed(path).body for one in bound(node))
        found += [f"{name(path)}: {one}" for one, times in names.items() if times > 1 and one != "_"]
    assert found == []
