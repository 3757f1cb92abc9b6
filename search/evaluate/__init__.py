"""Protocols and metrics: retrieval among synthetic, captioned and labelled clips, moments, and the model card."""
