"""Where in a take something happens: window scores, boundaries, sequences, segments."""
