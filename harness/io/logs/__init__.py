"""Logs of a robot's joints, of any format, and what there is to say of them."""
