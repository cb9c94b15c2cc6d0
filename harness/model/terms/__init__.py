"""The catalogue: one law a file."""
