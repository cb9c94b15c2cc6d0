"""Writes docs/api.md from the docstrings of the library: python docs/api_page.py."""

import ast
import inspect
import re
from enum import Enum
from pathlib import Path
from types import ModuleType

import harness
from harness import api, stages

DOCS = Path(__file__).resolve().parent
TARGET = DOCS / "api.md"

INTRODUCTION = """\
# From Python

Written by `python docs/api_page.py` from the docstrings. `import harness` gives the names below; it loads nothing until
one of them is used. `harness.api` has them too, with the types of the results, which are those of the command
([results](results.md)).

Arrays you have already go into `Recording(t, {"x": x, "a": a})` (seconds, metres, metres per second squared). Bad input
raises `harness.core.errors.InputError`, whose text is one line that says what is expected.

Every result prints itself: `print(result)` gives the verdict and the numbers, a notebook shows its page.
`result.to_frame()` is a pandas.DataFrame; `result.plots` names the plots of the page, that which answers first, and
`result.plot(name)` is one of them as a figure of plotly or, without that, of matplotlib; `result.curves` has the
motions, each with `t`, `x`, `v`, `a` as arrays in SI units (`harness.run().curves["mujoco tuned"]["v"]`). Nothing is
written unless `out` names a folder.

A model is built from terms of the catalogue by their keys ([the catalogue](terms.md)), as
`harness.Model(m, c, k, f_k, x0=0.1, terms=(harness.ModelTerm.named("end-stop", gap=0.05, k_stop=60.0),))`;
`harness.TERMS` has every `Term` with its law, its `Slot` and its parameters.

Below, `File` is a path as text or as a `Path`; a `GivenModel` is a `Model`, one as a result holds it, its plain data,
or the path of a model.json.

"""

EXAMPLE = """\
## A worked example

A slider on a spring (100 N/m per kg) that hits a stop of another 60 N/m per kg beyond 0.05 m on the positive side.
The recording is made here; yours would come from `harness.load("decay.csv")`.

```python
import numpy as np

import harness

truth = {
    "schema": "harness.model/1",
    "base": {"m": 1.0, "c": 0.4, "k": 100.0, "f_k": 0.3},
    "release": {"x0": 0.1},
    "terms": [{"name": "end-stop", "variant": "positive", "parameters": {"gap": 0.05, "k_stop": 60.0}}],
    "mass_known": False,
}
t = np.arange(0.0, 4.0, 0.004)
noise = np.random.default_rng(1)
motion = harness.simulate(truth, t)
recording = harness.Recording(
    t, {"x": motion.x + noise.normal(0.0, 1e-4, t.size), "a": motion.a + noise.normal(0.0, 0.05, t.size)}
)

result = harness.diagnose(recording, engines=["mujoco"])
print(result.verdict)
print(result.mechanisms[0].name)
print(result.mechanisms[0].statement)
print(f"chi-square per point {result.baseline.chi2_per_point:.1f} before, {result.refined.chi2_per_point:.2f} after")

again = harness.simulate(result.refined_model, t)
print(f"refined and true motion differ by at most {np.max(np.abs(again.x - motion.x)) * 1e6:.0f} um")
```

It prints:

```text
missing_physics
end-stop
A stop acts beyond 0.04997 +- 4e-05 m on the positive side: k_stop = 59.93 +- 0.08 N/m per kg.
chi-square per point 376.0 before, 0.99 after
refined and true motion differ by at most 13 um
```
"""


STEPS = ("prepare", "fit_base", "search", "judge", "explain", "statement")
STAGES = """\
## harness.stages

The steps of `harness.diagnose` one by one, for a program that looks in between or does a step its own way. Each gives
what the next one takes; nothing is written, and no engine is needed.

```python
import numpy as np

import harness
from harness import stages

drag = harness.ModelTerm.named("quadratic-drag", c2=2.0)
truth = harness.Model(1.0, 0.3, 100.0, 0.4, x0=0.1, terms=(drag,), mass_known=False)
t = np.arange(0.0, 4.0, 0.01)
x = harness.simulate(truth, t).x + np.random.default_rng(2).normal(0.0, 1e-5, t.size)

ready = stages.prepare(harness.Recording(t, {"x": x}), zero="spring")
print(f"noise of x {1e6 * ready.problem.noise['x'].sigma:.0f} um")
based = stages.fit_base(ready.problem)
print(f"chi-square per point {based.fit.chi2 / based.fit.points:.0f} with viscous and Coulomb friction alone")
found = stages.search(based)
print(", ".join(entry.term.name for entry in found.search.chosen.model.terms))
judged = stages.judge(found)
print(f"{judged.judgement.verdict}, by the rules {', '.join(rule.name for rule in judged.judgement.rules)}")
print(stages.statement(stages.explain(judged)))
```

It prints:

```text
noise of x 10 um
chi-square per point 5039 with viscous and Coulomb friction alone
quadratic-drag
missing_physics, by the rules among-names, structure-named
Missing physics: quadratic drag. A drag grows with the square of the speed: c2 = 2.0002 +- 0.0011 kg/m per kg.
```
"""


def text() -> str:
    """The page."""
    functions = [name for name in harness.__all__ if inspect.isfunction(getattr(api, name, None))]
    classes = [name for name in harness.__all__ if inspect.isclass(getattr(api, name, None))]
    parts = [_function(name) for name in functions] + [_class(name) for name in classes]
    steps = [_function(name, stages) for name in STEPS]
    return "".join((INTRODUCTION, EXAMPLE, "\n", *parts, STAGES, "\n", *steps)).rstrip() + "\n"


def _function(name: str, of: ModuleType = api) -> str:
    found = getattr(of, name)
    head = f"## harness.{name}" if of is api else f"### harness.stages.{name}"
    return f"{head}\n\n```python\n{_signature(name, found)}\n```\n\n{_doc(found)}\n\n"


def _class(name: str) -> str:
    """A class with what it offers beside its fields."""
    found = getattr(api, name)
    offered = {key: value for key, value in vars(found).items() if not key.startswith("_") and _doc(value, found)}
    rows = [f"| `{key}` | {_doc(value, found).splitlines()[0]} |" for key, value in offered.items()]
    table = "\n".join(["| name | gives |", "|---|---|", *rows]) + "\n\n" if rows else ""
    head = f"## harness.{name}\n\n```python\n{_signature(name, found)}\n```\n\n"
    return f"{head}{_doc(found)}\n\n{table}"


def _signature(name: str, found: object) -> str:
    """The call with an argument a line, types as they are written in the code."""
    (node,) = ast.parse(inspect.getsource(found)).body
    if inspect.isclass(found) and issubclass(found, Enum):
        return "\n".join(f'{name}.{member.name} = "{member.value}"' for member in found)
    if isinstance(node, ast.ClassDef):
        lines = [ast.unparse(field) for field in node.body if isinstance(field, ast.AnnAssign)]
        lines = [re.sub(r" = field\(.*\)$", " = ...", line) for line in lines]
        return f"{name}(\n" + "".join(f"    {line},\n" for line in lines) + ")"
    assert isinstance(node, ast.FunctionDef)
    first, rest = node.args.args, node.args.kwonlyargs
    defaults = [None] * (len(first) - len(node.args.defaults)) + node.args.defaults
    lines = [_argument(*pair) for pair in zip(first, defaults, strict=True)]
    lines += ["*"] * bool(rest) + [_argument(*pair) for pair in zip(rest, node.args.kw_defaults, strict=True)]
    return f"{name}(\n" + "".join(f"    {line},\n" for line in lines) + f") -> {ast.unparse(node.returns)}"


def _argument(argument: ast.arg, default: ast.expr | None) -> str:
    return ast.unparse(argument) + ("" if default is None else f" = {ast.unparse(default)}")


def _doc(found: object, of: object = None) -> str:
    """The docstring of a function, class or property of ``of``; empty for one that is inherited or not there."""
    found = found.fget if isinstance(found, property) else getattr(found, "__func__", found)
    if of is not None and not inspect.isfunction(found):
        return ""
    return inspect.cleandoc(found.__doc__ or "")


if __name__ == "__main__":
    TARGET.write_text(text(), encoding="utf-8")
