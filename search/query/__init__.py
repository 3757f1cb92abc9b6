"""Queries: sentences, their steps, paraphrases and vectors, filters, and the vocabulary of motion."""
