"""What a result shows: a page, which is a list of sections of blocks in one HTML file, and a scene for the viewer.

Both draw the same figures (plotly's traces and layout, NumPy arrays in place of lists).
"""
