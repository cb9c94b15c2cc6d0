"""Layouts of tables in text: every Layout that a file here makes is one, and is found by import."""
