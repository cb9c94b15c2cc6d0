"""Measured columns that act beside the motion: which are taken, and how each enters."""
