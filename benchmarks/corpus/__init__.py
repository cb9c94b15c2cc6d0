"""What the public API answers on some two hundred recordings and commands, kept beside the right answers."""
