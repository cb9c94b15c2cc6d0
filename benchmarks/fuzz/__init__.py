"""A search for what breaks a reader, steered by branches."""
