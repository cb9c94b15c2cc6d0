"""The scenarios of the suite: every Kind that a file here makes is one, and is found by import."""
