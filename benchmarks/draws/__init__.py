"""Fresh draws of what people ask, each answered through the public API: how many answers are right."""
