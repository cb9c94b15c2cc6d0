"""The smoothed state of a driven recording, its windows, and a first base model from inverse dynamics."""
