"""What moves between the rooms; imports nothing of ours."""
