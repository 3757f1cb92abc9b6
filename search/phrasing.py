"""Placeholder until the phrasings of the language land: a sentence as it is."""


def phrasings(sentence: str) -> list[str]:
    """The sentence itself."""
    return [sentence]
