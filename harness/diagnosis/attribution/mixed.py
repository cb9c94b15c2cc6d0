"""Models with the parameters of one and the terms of another, released as a third: the coalitions of the game."""

from dataclasses import replace

from harness.model.model import Model, ModelTerm

_FORCES = ("N", "kg")
"""How units begin that hold a mass; parameters with them scale with it where only forces per unit mass are known."""


def in_masses_of(model: Model, other: Model) -> Model:
    """A model with its forces per the mass of ``other``, where one of the two masses is not known."""
    if model.m == other.m or (model.mass_known and other.mass_known):
        return model
    by = other.m / model.m
    f_s = None if model.f_s is None else by * model.f_s
    terms = tuple(_scaled(entry, by) for entry in model.terms)
    return replace(
        model, m=other.m, c=by * model.c, k=by * model.k, f_k=by * model.f_k, f_s=f_s, terms=terms,
        mass_known=other.mass_known,
    )  # fmt: skip


def _scaled(entry: ModelTerm, by: float) -> ModelTerm:
    parameters = entry.term.parameters
    values = [
        value * by if p.unit.split("/")[0].split(" ")[0] in _FORCES else value
        for p, value in zip(parameters, entry.values, strict=True)
    ]
    return replace(entry, values=tuple(values))


def mixed(parameters: Model, terms: Model, released: Model) -> Model:
    """Base parameters of one model and terms of another, with start and sensor's zero of a third."""
    return replace(
        parameters, terms=terms.terms, x0=released.x0, v0=released.v0, t0=released.t0, offset=released.offset
    )


BASE = ("m", "c", "k", "f_k")


def moved(model: Model, read: Model, meant: Model) -> Model:
    """A model whose parameters an engine shows as far off as it shows those it was given.

    read : what the engine's trace reads. meant : what it was given. The stiffness moves by a factor, the frictions by
    what is added; none falls below nothing.
    """
    return replace(
        model,
        k=model.k * read.k / meant.k if meant.k > 0.0 and read.k > 0.0 else model.k,
        c=max(0.0, model.c + read.c - meant.c),
        f_k=max(0.0, model.f_k + read.f_k - meant.f_k),
        f_s=None,
    )
