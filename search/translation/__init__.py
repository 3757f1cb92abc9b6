"""Sentences of other languages: what they name, and the English sentences that are nearest in meaning."""
