"""Put the files of this folder into CHANGELOG.md, under the version of pyproject.toml: python changes/collect.py."""

import tomllib
from pathlib import Path

CHECKOUT = Path(__file__).resolve().parents[1]


def collected(changelog: str, version: str, items: list[str]) -> str:
    """The changelog with the items first under ``version``, whose heading is made where there is none."""
    heading = f"## {version}\n"
    if heading not in changelog:
        title, _, rest = changelog.partition("\n## ")
        changelog = f"{title.rstrip()}\n\n{heading}\n" + (f"\n## {rest}" if rest else "")
    before, _, after = changelog.partition(heading)
    listed, after = "".join(item.strip() + "\n" for item in items), after.lstrip()
    return f"{before}{heading}\n{listed}" + ("\n" if after.startswith("## ") else "") + after


if __name__ == "__main__":
    files = [file for file in sorted((CHECKOUT / "changes").glob("*.md")) if file.name != "README.md"]
    version = tomllib.loads((CHECKOUT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
    log = CHECKOUT / "CHANGELOG.md"
    items = [file.read_text(encoding="utf-8") for file in files]
    log.write_text(collected(log.read_text(encoding="utf-8"), version, items), encoding="utf-8")
    for file in files:
        file.unlink()
