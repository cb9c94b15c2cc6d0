"""A recording made ready: release, noise, the drive between samples."""
