"""The kinds of problem as procedures: one file a kind, which wires the rooms together."""
