"""harness run: one scenario, every source."""
