"""The blind proof: a plant of its own, sealed answers, scores. Knows the diagnosis only as a separate process."""
