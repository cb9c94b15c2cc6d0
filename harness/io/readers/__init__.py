"""The formats of recordings: every file here defines READER and is found by import."""
