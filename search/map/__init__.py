"""The map: a library's clips as points of a plane."""
