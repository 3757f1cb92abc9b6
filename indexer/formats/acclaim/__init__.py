"""Acclaim: skeletons (`asf`) and the motions that belong to them (`amc`, their numbers in `amc_frames`)."""
