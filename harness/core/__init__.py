"""What moves between the rooms; imports nothing of ours."""

__version__ = "0.1.0"
