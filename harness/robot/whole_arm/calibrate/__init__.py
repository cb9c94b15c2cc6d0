"""Simulated arms whose friction is known, and how much of it is found: python -m harness.robot.whole_arm.calibrate."""
