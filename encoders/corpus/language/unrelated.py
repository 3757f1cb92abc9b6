"""Out-of-domain sentences: negatives for every motion in training."""

from __future__ import annotations

import numpy as np

_THINGS = (
    "contract", "budget", "password", "server", "spreadsheet", "weather report", "tax return", "recipe", "novel",
    "newspaper", "mortgage", "battery", "engine", "printer", "database", "keyboard layout", "meeting agenda",
    "train ticket", "insurance claim", "bank account", "electricity bill", "holiday calendar", "language course",
    "chess opening", "violin concerto", "oil painting", "tomato soup", "chocolate cake", "green tea",
    "mountain range", "river delta", "solar panel", "satellite", "planet", "galaxy", "molecule", "vaccine",
    "medical record", "x-ray image", "blood test", "court decision", "constitution", "election", "parliament",
    "stock price", "interest rate", "shipping address", "warehouse inventory", "purchase order", "software licence",
    "user manual", "error message", "web page", "search result", "photograph", "radio station", "phone number",
    "street map", "parking permit", "rental car", "hotel room", "airport", "concert hall", "museum", "library card",
    "dictionary", "poem", "short story", "crossword puzzle", "garden fence", "brick wall", "wooden table",
    "kitchen sink", "washing machine", "carpet", "curtain", "ceiling lamp", "apple tree", "rose bush", "cactus",
    "sparrow", "elephant", "goldfish", "cat food", "black dog", "honey", "cheese", "pepper", "olive oil",
    "copper wire", "steel beam", "gravel road", "snow storm", "thunder", "rainbow", "desert", "volcano", "ocean tide",
    "history lesson", "algebra", "geometry proof", "prime number", "matrix",
)  # fmt: skip
_FRAMES = (
    "{a}", "the {a}", "{a} and {b}", "{a} of the {b}", "how to file a {a}", "price of a {a}", "a red {a}", "{q} {a}",
    "what is the best {a} in {p}", "the {a} is next to the {b}", "please send me the {a}", "{a} for {m}", "{m} {a}",
    "a picture of a {a}", "new {a} available from {m}", "why is the {a} so expensive", "the {a} was published in {p}",
    "{a} version {n}", "{n} {a}s", "the {b} needs a {a}", "compare {a} with {b}", "is the {a} ready by {m}",
    "{a} near {p}",
)  # fmt: skip
_QUALITIES = (
    "cheap", "digital", "annual", "broken", "organic", "historical", "public", "quarterly", "blue", "empty",
)  # fmt: skip
_PLACES = (
    "Paris", "Brazil", "the office", "Tokyo", "the north", "chapter two", "the appendix", "Kenya", "space",
    "the cellar",
)  # fmt: skip
_MONTHS = (
    "January", "April", "June", "August", "October", "December", "Monday", "next year", "the winter", "tomorrow",
)  # fmt: skip
_WORDS = (
    "lorem", "ipsum", "dolor", "asdf", "qwerty", "xyzzy", "foo", "bar", "zzz", "null", "0x3f", "select", "http",
    "blah",
)  # fmt: skip


def unrelated_sentence(rng: np.random.Generator) -> str:
    """A sentence that describes no motion: about things, places and dates, or gibberish."""
    if rng.random() < 0.15:
        return " ".join(rng.choice(_WORDS, size=int(rng.integers(1, 5))))
    a, b = rng.choice(_THINGS, size=2, replace=False)
    return str(rng.choice(_FRAMES)).format(
        a=a,
        b=b,
        q=rng.choice(_QUALITIES),
        p=rng.choice(_PLACES),
        m=rng.choice(_MONTHS),
        n=int(rng.integers(2, 2000)),
    )


def unrelated_sentences(count: int, seed: int = 0) -> list[str]:
    """Distinct out-of-domain sentences."""
    rng = np.random.default_rng(seed)
    found = dict.fromkeys(unrelated_sentence(rng) for _ in range(2 * count))
    return list(found)[:count]
