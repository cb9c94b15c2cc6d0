"""harness dataset: published benchmarks."""
