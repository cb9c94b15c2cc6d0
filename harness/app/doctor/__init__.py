"""harness doctor: what works on this machine."""
