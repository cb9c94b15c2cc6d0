"""Numerics of fitting that know no model: least squares, covariances, whitening, autocorrelation."""
