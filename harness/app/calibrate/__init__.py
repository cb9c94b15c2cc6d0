"""Simulations that rules of a verdict come from: ``python -m harness.app.calibrate NAME`` repeats one."""
