"""Moments: where in a motion a query is answered; window scores, boundaries, sequences, segments."""
