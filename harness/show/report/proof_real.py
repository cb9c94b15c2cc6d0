"""Of a proof on real machines: machine by machine, and what their files could not be asked."""

from harness.results.prove import RealResult
from harness.show import blocks as b
from harness.show.report.proof_figures import rated

_HEADS = {
    "told": "constructed laws named or listed",
    "moved": "constructed gain, clock, damping: its number alone moved",
    "wrong": "constructed, called another",
    "alarms": "delays called anything",
    "switched": "switched causes first, alone",
    "switched_wrong": "switched, another cause",
    "repeats": "repeats called different",
}


def machines(found: RealResult) -> b.Section:
    columns = [
        b.Column("files", lambda one: str(one.files)),
        *(b.Column(head, b.by(key, lambda one, name: rated(getattr(one, name)))) for key, head in _HEADS.items()),
    ]
    caption = "With exact 95 % intervals; those of the figures above are resampled over machines."
    table = b.tabulated("machine", columns, found.machines, lambda one: one.machine, caption=caption)
    missing = [b.Items(found.not_run)] if found.not_run else []
    return b.Section("Machine by machine", [table, *missing])
