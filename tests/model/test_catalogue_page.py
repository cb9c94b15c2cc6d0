"""docs/terms.md is the page that follows from the registry, and names every catalogue entry."""

from harness.model import catalogue
from harness.model.registry import TERMS


def test_the_page_is_the_one_of_the_registry() -> None:
    assert catalogue.TARGET.read_text(encoding="utf-8") == catalogue.text(), "run python -m harness.model.catalogue"


def test_every_term_is_on_it_with_a_page_of_its_own() -> None:
    page = catalogue.text()
    for term in TERMS:
        assert page.count(f"| [{term.key}]({catalogue.page_of(term)}.md) |") == 1
        own = (catalogue.TARGET.parent / f"{catalogue.page_of(term)}.md").read_text(encoding="utf-8")
        for parameter in term.parameters:
            assert f"| `{parameter.name}` | {parameter.unit} |" in own
