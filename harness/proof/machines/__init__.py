"""Recordings as real machines make them: one large omission among small ones, a hand, a zero, sensors as they are.

It shares laws, integrator and base fit with ``harness.proof.plant`` and nothing with the diagnosis.
"""
