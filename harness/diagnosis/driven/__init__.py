"""Driven recordings: a measured force, windows restarted from the smoothed recorded state, noise of force and sensors."""
