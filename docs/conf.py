"""The site made of these pages, which look up nothing in any network: sphinx-build -q -W --keep-going docs SITE."""

import re
from pathlib import Path
from runpy import run_path
from typing import Any

from docutils.nodes import SkipNode
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx

import harness

HERE = Path(__file__).resolve().parent
project = "friction-harness"
author = "friction-harness contributors"
version = release = harness.__version__
extensions = ["myst_parser"]
exclude_patterns = ["example"]
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4
html_theme = "furo"
html_title = f"friction-harness {release}"
html_static_path = ["site.css"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sphinx = html_show_copyright = False
html_math_renderer = "mathml"
html_theme_options = {"source_repository": "", "navigation_with_keys": True}
pygments_style, pygments_dark_style = "default", "github-dark"


def contents(app: Sphinx, page: str, source: list[str]) -> None:
    """The sections of index.md and the pages linked in each are the navigation; terms.md has those of terms.

    What proofs missed is that of the published ones, now.
    """
    if page == "limits" and (HERE.parent / "reports").is_dir():
        source[0] = run_path(str(HERE / "limits.py"))["text"](source[0])
    if page in ("index", "terms"):
        source[0] = re.sub(r"^## ([^\n]+)\n(.*?)(?=^## |\Z)", _section, source[0], flags=re.MULTILINE | re.DOTALL)


def _section(found: re.Match[str]) -> str:
    pages = dict.fromkeys(re.findall(r"\]\((?!\.\.|https?:)([\w/-]+)\.md\)", found[2]))
    if not pages:
        return found[0]
    return "\n".join([found[0], "```{toctree}", ":hidden:", f":caption: {found[1]}", "", *pages, "```", ""])


def _mathml(self: Any, node: Any) -> None:
    """An equation as the browser sets it, without a script."""
    block = node.tagname == "math_block"
    made = tex2mathml(node.astext(), as_block=block)
    self.body.append(f"<div class='math'>{made}</div>" if block else made)
    raise SkipNode


def setup(app: Sphinx) -> None:
    """What sphinx calls first."""
    app.connect("source-read", contents)
    app.add_html_math_renderer("mathml", inline_renderers=(_mathml, None), block_renderers=(_mathml, None))
