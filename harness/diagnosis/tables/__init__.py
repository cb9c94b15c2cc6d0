"""Tabulated forces for what has no name: smooth tables of position and speed, kept only where they predict."""
