"""The command ``harness``: parse, call the use case, print. Everything heavy is imported inside the commands."""
