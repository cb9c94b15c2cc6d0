"""Clean logs of arms in closed loop, from a plant that sticks and from engines themselves: ``python -m
benchmarks.robot_logs``."""
