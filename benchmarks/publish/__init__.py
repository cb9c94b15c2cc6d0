"""What stands in reports/, made anew: ``python -m benchmarks.publish``."""
