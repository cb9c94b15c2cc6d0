"""The search for the terms that a base fit lacks."""
