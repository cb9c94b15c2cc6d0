"""Sections of the page of a sweep that hold without any row."""
