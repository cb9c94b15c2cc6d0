"""The page of models compared on one recording: the ranking, and what each leaves."""

from pathlib import PurePath

from harness.results.models import ComparedModel, ModelsResult
from harness.show import blocks as b
from harness.show.numbers import number, of_names
from harness.show.plots import ANGLES, CHANNELS, GROUP, axes, curve, left_by, per


def models_page(result: ModelsResult, angular: bool = False) -> b.Page:
    """Residuals are the curves of the result."""
    colors = dict(zip((one.name for one in result.models), of_names(len(result.models)), strict=True))
    first = result.models[0]
    columns = [
        b.Column("terms", lambda one: ", ".join(one.terms) or "none"),
        b.Column("fitted", lambda one: str(one.fitted), "", "numbers that were fitted"),
        b.Column("chi-square per point", lambda one: number(one.chi2_per_point, 4), "", "1 when only noise is left"),
        b.Column("worse by", lambda one: number(one.delta_bic, 3), "BIC"),
        b.Column("weight", lambda one: number(one.weight, 2), "", "probability among these models"),
        *(
            b.Column(
                n,
                b.by(n, lambda one, n: b.measured(one.parameters.get(n))),
                p.unit.replace("m", "mm", 1) if p.unit == "m" else p.unit,
            )
            for n, p in first.parameters.items()
        ),
    ]

    def color(one: ComparedModel) -> str:
        return colors[one.name]

    table = b.tabulated("model", columns, result.models, lambda one: one.name, lambda one: one.note, color)
    figures = []
    for c in first.rmse:
        label, unit, factor = (ANGLES if angular else CHANNELS)[c]
        traces = [
            curve(name, own["t"], own[c] * factor, colors[name], unit, 1.2) for name, own in result.curves.items()
        ]
        caption, band = left_by("model", result.recording.noise.get(c), unit, factor)
        layout = axes("time / s", f"residual of {label} / {per(unit)}", shapes=band, showlegend=True)
        figures.append(b.Figure(f"residual-{c}", traces, layout, caption, GROUP, 300))
    about = result.recording
    sections = [b.verdict(result.statement), b.Section("Ranking", [table]), b.Section("Residuals", figures)]
    return b.Page(
        f"Models of {PurePath(about.file).name}", f"{about.samples} samples, {about.duration_s:.4g} s", sections
    )
