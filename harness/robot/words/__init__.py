"""Which words of friction, damping, armature and servos a model's file has, and what each reader makes of them."""
