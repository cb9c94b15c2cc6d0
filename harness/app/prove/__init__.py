"""harness prove: the sealed blind proof."""
