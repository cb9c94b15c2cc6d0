"""The page: a list of sections, one HTML file. A run, a recording, a diagnosis and a sweep are lists of sections.

A section is a small class with a template and a context (``section.py``). What it shows is made of tables
(``table.py``), figures (``figure.py``: plotly's traces and layout, NumPy arrays in place of lists) and sentences;
``page.write_report`` turns a list of them into a file that needs no network.
"""
