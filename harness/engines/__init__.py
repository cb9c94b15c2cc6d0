"""Physics engines behind one small interface; each is found through the entry points of group harness.engines."""
