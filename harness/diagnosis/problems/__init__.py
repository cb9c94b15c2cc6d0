"""The kinds of problem as data: what each knows of itself, for the rooms that do not ask which one it is."""
