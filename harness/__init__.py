"""Cross-validation of dry friction in physics engines."""

__version__ = "0.1.0"
