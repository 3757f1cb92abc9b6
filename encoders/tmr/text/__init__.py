"""The frozen language model and its token features of sentences."""
