"""Recordings that are traces of an engine that steps."""
