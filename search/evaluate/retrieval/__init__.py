"""Retrieval on captioned data sets by the protocols of the TMR paper."""
