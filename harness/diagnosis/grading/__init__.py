"""How much of a misfit one term takes, where none explains it: words, evidence, prediction, grades."""
