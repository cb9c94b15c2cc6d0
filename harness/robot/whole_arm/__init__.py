"""Friction of the joints from a log in which the whole arm moves: what torque the rigid model leaves over."""
