"""harness identify: the estimators on a recording."""
