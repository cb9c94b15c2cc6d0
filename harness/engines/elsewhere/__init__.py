"""Engines in a process of their own, of this interpreter or of another one."""
