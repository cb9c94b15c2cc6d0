"""A plant with its own laws, integrated by SciPy: it shares no law, kernel or estimator with the fitting side.

Imports harness.core, numpy and scipy alone, so that agreement between plant and diagnosis says something.
"""

from harness.proof.plant.cases import Case, draw
from harness.proof.plant.effects import ALIENS, FAMILY, KINDS
from harness.proof.plant.integrate import PlantRun, simulate
from harness.proof.plant.model import PlantModel

__all__ = ["ALIENS", "FAMILY", "KINDS", "Case", "PlantModel", "PlantRun", "draw", "simulate"]
