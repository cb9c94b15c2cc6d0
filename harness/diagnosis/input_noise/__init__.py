"""Noise of a measured force along the motion of a model, and fits under it."""
