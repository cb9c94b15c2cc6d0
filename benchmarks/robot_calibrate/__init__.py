"""Simulated arms whose friction is known, and how much of it is found: python -m benchmarks.robot_calibrate."""
