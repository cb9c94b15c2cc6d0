"""Speed, always as a ratio against a peer timed in the same run: ``python -m benchmarks --json FILE``.

A module here adds rows with ``benchmarks.registry.benchmark``; every module of the package is found by itself.
"""
