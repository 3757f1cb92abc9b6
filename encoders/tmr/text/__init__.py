"""The frozen language model and the token features it gives of sentences."""
