"""Noise of a measured force: what it does to the motion, and residuals whitened by it."""
