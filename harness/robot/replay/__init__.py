"""A joint of the user's model driven by its log's torque in MuJoCo and PyBullet, the other joints led along the log."""
