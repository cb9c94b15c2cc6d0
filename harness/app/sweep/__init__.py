"""harness sweep, regress and tune."""
