"""The use cases; the only room that wires the others."""
