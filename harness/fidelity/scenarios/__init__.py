"""The scenarios of the suite: every file here defines SCENARIO, named as the file, and is found by import."""
