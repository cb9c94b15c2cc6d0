"""Real machines: recordings with exact constructed effects, and machines of which one cause was switched."""
