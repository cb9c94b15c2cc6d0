"""A robot: the log of its joints, and its bodies as they are drawn."""
