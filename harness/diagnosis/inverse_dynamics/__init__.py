"""Driven recordings that are fitted in their force."""
