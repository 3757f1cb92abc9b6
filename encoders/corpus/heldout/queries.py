"""Queries for held-out actions and styles, and held-out paraphrases for known actions."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cache
from pathlib import Path

from numpy.random import Generator

ACTION_QUERIES: dict[str, tuple[str, ...]] = {
    "burpee": (
        "a person does burpees", "someone squats, kicks the legs back and leaps up", "burpees",
        "a man drops to a push up position and jumps up with raised arms",
    ),
    "discus throw": (
        "a person throws a discus", "discus throw", "someone winds up, spins round and hurls a discus",
        "the person swings one arm back and spins to throw",
    ),
    "kettlebell swing": (
        "a person swings a kettlebell", "kettlebell swings", "someone swings a weight between the legs and up in front",
        "a man swings both arms from between the knees to eye level",
    ),
    "sumo stomp": (
        "a person stomps like a sumo wrestler", "sumo wrestler stomping", "a wrestler lifts one leg high to the side, "
        "then the other", "someone in a wide squat raises each leg sideways and stamps it down",
    ),
    "sow seeds": (
        "a person sows seeds", "someone scatters seeds from a bag with one hand", "sowing a field by hand",
        "the person strews something in wide arcs",
    ),
    "turn crank": (
        "a person turns a crank", "someone winds a winch with both hands", "cranking a handle round and round",
        "a man turns the handle of a well",
    ),
    "ring bell": (
        "a person rings a church bell", "someone pulls down on a bell rope from above", "ringing a big bell",
        "a person pulls something down from above the head with both hands",
    ),
    "kayak": (
        "a person paddles a kayak", "kayaking", "someone paddles on the left and on the right in turn",
        "a man moves a double paddle from side to side",
    ),
    "tie ponytail": (
        "a person ties a ponytail", "a woman ties up her hair", "someone puts both hands behind the head to tie hair",
        "tying hair into a ponytail",
    ),
    "pump tyre": (
        "a person pumps up a tyre", "someone works a bicycle pump", "pumping up a bike tire",
        "a person bends over and pushes down a handle again and again",
    ),
    "play accordion": (
        "a person plays the accordion", "accordion player", "playing a squeezebox",
        "someone draws the hands apart and together before the chest",
    ),
    "milk cow": (
        "a person milks a cow", "milking a cow", "someone crouches and pulls down with one hand after the other",
        "a farmer squats and milks",
    ),
}  # fmt: skip

STYLE_PHRASES: dict[str, tuple[str, ...]] = {
    "wading": ("as if wading through deep water", "like in knee-deep snow"),
    "on ice": ("as if on slippery ice", "carefully, as on a frozen lake"),
    "bloated": ("as if stuffed after a feast", "with a full, heavy belly"),
    "soldierly": ("like a drilled guardsman", "with parade-ground stiffness"),
    "freezing": ("as if freezing", "huddled against a cold wind"),
    "weightless": ("as if weightless", "dreamily, as if floating on air"),
    "stiff-necked": ("as if wearing a neck brace", "without moving the neck"),
    "swaggering": ("like a cowboy after a long ride", "bow-legged"),
}


def action_query(action: str, rng: Generator) -> str:
    """A random query for a held-out action."""
    return str(rng.choice(ACTION_QUERIES[action]))


def with_style(text: str, style: str, rng: Generator) -> str:
    """The sentence with a phrase for a held-out style."""
    return f"{text.rstrip(' .')} {rng.choice(STYLE_PHRASES[style])}"


@cache
def paraphrase_queries() -> Mapping[str, tuple[str, ...]]:
    """Action -> human sentences for it; excluded from training, and their phrases are not in the lexicon."""
    stored = json.loads((Path(__file__).parent / "paraphrase_queries.json").read_text("utf-8"))
    return {action: tuple(sentences) for action, sentences in stored.items()}
