"""The page: a list of sections, one HTML file. A run, a recording, a diagnosis and a sweep are lists of sections."""
