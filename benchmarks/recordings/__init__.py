"""Folders of recordings with concealed effects, and how well diagnoses of machines match their answers."""
