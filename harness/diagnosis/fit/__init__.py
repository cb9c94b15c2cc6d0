"""A model's motion seen by sensors, fitted to a recording by least squares."""
