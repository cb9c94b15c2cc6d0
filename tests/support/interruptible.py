"""Processes that a test can interrupt: a test run started in the background hands on that SIGINT is ignored."""

import signal


def listening() -> None:
    """For preexec_fn: SIGINT as a terminal would deliver it."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
