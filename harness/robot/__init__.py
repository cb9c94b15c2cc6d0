"""A robot's joints: its model, its log, and the torque that friction must have had."""
