"""The question: sentences, their steps and paraphrases, filters, and the vocabulary of movement."""
