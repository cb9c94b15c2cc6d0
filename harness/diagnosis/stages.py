"""What passes from one step of a diagnosis to the next."""

from dataclasses import dataclass
from typing import Any, Generic

from harness.diagnosis.fit.model_fit import Fit
from harness.diagnosis.grading.grade import Graded
from harness.diagnosis.integrator_maps import Stepping
from harness.diagnosis.inverse_dynamics.grade import ForceGraded
from harness.diagnosis.pooling.pooled import Pooled
from harness.diagnosis.problem import P
from harness.diagnosis.search.search import Search
from harness.diagnosis.verdict import Judgement
from harness.kernels.solve import Scales


@dataclass(frozen=True, slots=True)
class Based(Generic[P]):
    """A recording with its base model.

    whole : the problem as it was prepared. problem : the one to search in, under the noise that the base leaves; of a
    very long free decay it holds means of neighbours. fit : of the base model to it. scales : what counts as ordinary.
    """

    whole: P
    problem: P
    fit: Fit
    scales: Scales


@dataclass(frozen=True, slots=True)
class Found:
    """What a search has come to, on all samples.

    coarse : the search as it was, where its samples were means: what was held out is predicted in it. stepping : of the
    engine whose trace the recording is. notes : what a reader is to know of it, one sentence
    each. by_force : grades of a fitted force, where more than noise is left. pooled : what several recordings share.
    left_out : what of the recording was not looked at, one sentence each, said first.
    """

    search: Search
    scales: Scales
    coarse: Search
    stepping: Stepping | None = None
    notes: tuple[str, ...] = ()
    by_force: ForceGraded | None = None
    pooled: Pooled[Any] | None = None
    left_out: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Judged:
    """What was found, with its verdict. graded : the catalogue graded by its shares, where no model explains all."""

    found: Found
    judgement: Judgement
    graded: Graded | None = None
