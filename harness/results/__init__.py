"""Pydantic models of every result file; a JSON Schema is generated from each and shipped. Imports core only."""
