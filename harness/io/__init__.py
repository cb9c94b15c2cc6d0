"""Reading recordings in their formats and units, and writing results so that nothing half-written stays."""
