"""How faithful an engine's dry friction is: metrics of its traces against exact answers."""
