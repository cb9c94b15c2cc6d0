"""The formats of recordings: every Reader that a file here makes is one, and is found by import."""
