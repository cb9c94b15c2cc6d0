"""Several logs of one robot: in which joints friction is not the same."""
