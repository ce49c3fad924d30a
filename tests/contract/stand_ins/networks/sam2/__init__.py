"""Replaces SAM 2, with only the image predictor that the adapter uses."""
