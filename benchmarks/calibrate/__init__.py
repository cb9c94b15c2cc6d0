"""Simulations that rules of a verdict come from: ``python -m benchmarks.calibrate NAME`` repeats one."""
