"""Runs examples/friction.ipynb, keeps what its cells print and draw in it, and makes docs/notebook.md of both.

python docs/notebook.py; needs matplotlib, and no notebook program.
"""

import ast
import base64
import io
import json
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

import matplotlib
from matplotlib.figure import Figure

HERE = Path(__file__).resolve().parent
NOTEBOOK, PAGE = HERE.parent / "examples" / "friction.ipynb", HERE / "notebook.md"
_HEAD = (
    "Written by `python docs/notebook.py` from [examples/friction.ipynb](../examples/friction.ipynb), which it runs.\n"
)


def run(cells: list[dict[str, Any]]) -> None:
    """Execute the cells in one namespace, each with what it prints and its last value as outputs."""
    space: dict[str, Any] = {"__name__": "__main__"}
    for number, cell in enumerate((one for one in cells if one["cell_type"] == "code"), 1):
        tree, said, last = ast.parse("".join(cell["source"])), io.StringIO(), None
        with redirect_stdout(said):
            if tree.body and isinstance(tree.body[-1], ast.Expr):
                final = ast.Expression(tree.body.pop().value)
                exec(compile(tree, NOTEBOOK.name, "exec"), space)
                last = eval(compile(final, NOTEBOOK.name, "eval"), space)
            else:
                exec(compile(tree, NOTEBOOK.name, "exec"), space)
        cell["execution_count"], cell["outputs"] = number, _outputs(said.getvalue(), last, number)


def _outputs(said: str, last: object, number: int) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = []
    if said:
        found.append({"output_type": "stream", "name": "stdout", "text": said.splitlines(keepends=True)})
    if isinstance(last, Figure):
        with matplotlib.rc_context({"svg.hashsalt": "friction", "savefig.dpi": 80}):
            picture = io.BytesIO()
            last.savefig(picture, format="png", metadata={"Software": None})
        data = {"image/png": base64.b64encode(picture.getvalue()).decode(), "text/plain": ["a figure"]}
    elif last is not None:
        data = {"text/plain": str(last).splitlines(keepends=True)}
    else:
        return found
    return [*found, {"output_type": "execute_result", "execution_count": number, "metadata": {}, "data": data}]


def page(cells: list[dict[str, Any]]) -> tuple[str, dict[str, bytes]]:
    """The notebook as a page, and the pictures on it by their file."""
    parts, pictures = list[str](), dict[str, bytes]()
    for cell in cells:
        source = "".join(cell["source"])
        parts.append(source if cell["cell_type"] == "markdown" else f"```python\n{source}\n```")
        for one in cell.get("outputs", ()):
            data = one.get("data", {})
            if "image/png" in data:
                name = f"pictures/notebook-{len(pictures) + 1}.png"
                pictures[name] = base64.b64decode(data["image/png"])
                parts.append(f"![what the cell draws]({name})")
            else:
                said = "".join(one.get("text") or data["text/plain"]).rstrip()
                parts.append(f"```text\n{said}\n```")
        if len(parts) == 1:
            parts.append(_HEAD)
    return "\n\n".join(parts) + "\n", pictures


if __name__ == "__main__":
    notebook = json.loads(NOTEBOOK.read_text(encoding="utf-8"))
    run(notebook["cells"])
    NOTEBOOK.write_text(json.dumps(notebook, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    text, drawn = page(notebook["cells"])
    PAGE.write_text(text, encoding="utf-8")
    for name, content in drawn.items():
        (HERE / name).write_bytes(content)
