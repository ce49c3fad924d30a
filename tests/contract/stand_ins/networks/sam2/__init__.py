"""Stands in for SAM 2, of which the adapter uses the predictor of one picture."""
