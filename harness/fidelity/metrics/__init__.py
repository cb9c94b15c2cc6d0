"""Metrics of a trace against the exact motion; each is one small function that says what a good value is."""
