"""Whose a mismatch is: engine, parameters and missing physics as players of a game, in windows of about a period."""
