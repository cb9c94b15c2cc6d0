"""Closed forms: free decay, moving belt, harmonic forcing, static hold."""
