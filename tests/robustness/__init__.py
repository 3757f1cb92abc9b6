"""Whether a library can be trusted: killed, mutated, flipped, out of room, read while it is written.

The trials are here, each of a seed; `benchmarks/robustness.py` runs many of them, the tests beside them some.
"""
