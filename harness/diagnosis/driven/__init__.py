"""Driven recordings: a measured force, windows restarted from the smoothed state, noise of force and sensors."""
