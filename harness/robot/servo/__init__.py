"""A servo as part of the plant: a joint's friction and drive from its goal and its position alone."""
