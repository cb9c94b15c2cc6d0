"""harness compare: two traces."""
