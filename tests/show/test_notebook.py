"""A result in a notebook: the page in a frame, the numbers as a table."""

import pickle
import sys
from html import unescape
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from harness.core.errors import InputError
from harness.core.recording import Recording
from harness.results.identify import IdentifyResult
from harness.show.report.identify import identify_page
from harness.show.report.page import render


def test_a_result_shows_its_page_from_memory_or_from_its_file(
    identify_result: IdentifyResult, recording: Recording, tmp_path: Path
) -> None:
    assert identify_result._repr_html_() is None
    page = identify_page(identify_result, recording)
    drawn = identify_result.model_copy(deep=True).drawn(lambda result: identify_page(result, recording))
    shown = drawn._repr_html_()
    assert shown is not None
    assert unescape(shown.partition('srcdoc="')[2].partition('" style')[0]) == render(page)
    assert drawn == identify_result
    report = tmp_path / "report.html"
    report.write_text(render(page), encoding="utf-8")
    written = pickle.loads(pickle.dumps(identify_result.model_copy(update={"files": {"report": str(report)}})))
    assert written._repr_html_() == shown


def test_numbers_with_errors_and_units_are_a_table(
    identify_result: IdentifyResult, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(InputError, match="pip install pandas"):
        identify_result.to_frame()

    class Frame(SimpleNamespace):
        def astype(self, kinds: dict[str, type]) -> "Frame":
            return Frame(kinds=kinds, **vars(self))

    pandas: Any = SimpleNamespace(
        MultiIndex=SimpleNamespace(from_tuples=lambda pairs, names: (names, pairs)),
        DataFrame=lambda columns, index: Frame(columns=columns, index=index),
    )
    monkeypatch.setitem(sys.modules, "pandas", pandas)
    table = identify_result.to_frame()
    names, places = table.index
    assert names == ["part", "quantity"]
    at = places.index(("estimates.acceleration", "x_k"))
    x_k = identify_result.estimates["acceleration"].x_k
    assert [table.columns[name][at] for name in table.columns] == [x_k.value, x_k.stderr, x_k.unit, x_k.why]
    assert places[-1] == ("", "sensor_phase_rad")
    assert table.kinds == {"value": float, "stderr": float}
