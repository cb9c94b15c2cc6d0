"""harness diagnose: one recording or many."""
