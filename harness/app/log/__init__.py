"""harness log: what a log of a robot's joints holds."""
