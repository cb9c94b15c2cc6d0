"""A plant with its own laws, integrated by SciPy: it shares no law, kernel or estimator with the fitting side.

Imports harness.core, numpy and scipy alone, so that agreement between plant and diagnosis says something.
"""
