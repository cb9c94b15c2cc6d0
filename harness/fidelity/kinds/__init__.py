"""Kinds of scenario: what acts on the slider, its exact motion and answers, and what is measured."""
