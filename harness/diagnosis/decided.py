"""Is a pair of terms decided, or would a pair of another kind do as well?

Two terms, one of them a flexible law, can follow an effect that no catalogue holds as well as they follow their own.
Such a pair has near relatives: exchange a term for one of another family, and little is lost. Of 10 true pairs with a
flexible law 8 stood further apart from the next of other families, of 8 that mimicked an effect of no catalogue 2 did.
"""

from harness.diagnosis.fit import Fit
from harness.diagnosis.search import Search
from harness.diagnosis.select import DECISIVE

_FLEXIBLE = 3
"""Parameters from which a law bends to nearly anything when it has company."""
_APART = 3.0 * DECISIVE
"""What another family must lose in BIC: pairs are some twenty times as many as names, and each fits something."""


def families_of(found: Fit) -> frozenset[str]:
    """Families of a fit's terms."""
    return frozenset(entry.term.family for entry in found.model.terms)


def doubt(found: Search) -> Fit | None:
    """The best pair of other families that a pair is not told apart from, None where what was found is decided."""
    chosen = found.chosen
    if len(chosen.model.terms) < 2 or all(len(entry.values) < _FLEXIBLE for entry in chosen.model.terms):
        return None
    near = [r for r in found.rivals if families_of(r) != families_of(chosen) and r.bic < chosen.bic + _APART]
    return min(near, key=lambda f: f.bic, default=None)
