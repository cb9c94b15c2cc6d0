"""The page of several diagnoses: one row a recording, with a link to its own page."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import PurePath
from typing import Any, ClassVar

from harness.show.numbers import number
from harness.show.report.section import Section
from harness.show.report.verdict import Verdict

VERDICTS = {
    "missing_physics": "physics left out",
    "main_effect": "main effect",
    "one_of": "one of several",
    "adequate": "adequate",
    "unexplained": "unexplained",
    "error": "could not be diagnosed",
}


def index_title(answers: Sequence[Mapping[str, Any]]) -> tuple[str, str]:
    """Title and subtitle of the page."""
    counts = Counter(answer["verdict"] for answer in answers)
    said = ", ".join(f"{counts[verdict]} {words}" for verdict, words in VERDICTS.items() if counts[verdict])
    return f"What simulations leave out of {len(answers)} recordings", said


def index_sections(answers: Sequence[Mapping[str, Any]], command: str) -> list[Section]:
    """Sections of the page. answers : entries of harness.diagnosis/2, each with "link", its page or ""."""
    counts = Counter(m["name"] for answer in answers for m in answer["mechanisms"])
    named = ", ".join(f"{name} ({count})" for name, count in counts.most_common())
    headline = f"Left out: {named}." if named else "No physics was found to be left out."
    sentences = [
        f"{answer['recording']['file']}: {answer['error']}" for answer in answers if answer["verdict"] == "error"
    ]
    return [Verdict(headline, sentences, heading="Over all recordings"), Recordings(answers, command)]


@dataclass(frozen=True)
class Recordings(Section):
    """answers : entries with "link". command : the line that makes it again."""

    template: ClassVar[str] = "recordings.html.j2"
    answers: Sequence[Mapping[str, Any]]
    command: str

    @property
    def title(self) -> str:
        """The heading."""
        return "Recordings"

    def context(self) -> Mapping[str, Any]:
        """What the template shows."""
        rows = [
            {
                "name": PurePath(answer["recording"]["file"]).name,
                "link": answer["link"],
                "verdict": VERDICTS[answer["verdict"]],
                "names": ", ".join(m["name"] for m in answer["mechanisms"]),
                "others": ", ".join(a["name"] for m in answer["mechanisms"] for a in m["alternatives"]),
                "before": number((answer.get("baseline") or {}).get("chi2_per_point"), 4),
                "after": number((answer.get("refined") or {}).get("chi2_per_point"), 4),
            }
            for answer in self.answers
        ]
        return {"rows": rows, "command": self.command}
