"""Make tests/data/tiny_bundle, with torch; tests then use it without: `python -m tests.encoders.tiny_bundle`.

A whole bundle of random weights, some 100 kB: every code path of the runtime, and no meaning.
"""

from __future__ import annotations

import string
from pathlib import Path

import numpy as np
import torch
from tokenizers import Tokenizer
from tokenizers.models import WordPiece
from tokenizers.normalizers import BertNormalizer
from tokenizers.pre_tokenizers import BertPreTokenizer
from tokenizers.processors import TemplateProcessing

from encoders.features.registry import FEATURE_KINDS
from encoders.tmr.conversion.to_bundle import export_bundle
from encoders.tmr.model.network import TMR, TMRConfig, TransformerConfig
from encoders.tmr.text.language_model import LanguageConfig, LanguageModel, LanguageNetwork

FOLDER = Path(__file__).resolve().parent.parent / "data" / "tiny_bundle"
WORDS = (
    "a", "an", "the", "person", "man", "woman", "someone", "is", "walks", "walking", "runs", "running", "jumps",
    "jumping", "sits", "down", "stands", "up", "turns", "left", "right", "waves", "waving", "kicks", "punches",
    "throws", "forward", "backwards", "slowly", "quickly", "then", "and", "with", "arm", "hand", "leg", "foot",
    "both",
)  # fmt: skip


def tiny_language(width: int = 16, layers: int = 1) -> LanguageModel:
    """A language model of random weights that knows a few words and all letters."""
    letters = string.ascii_lowercase + string.digits + string.punctuation
    pieces = ["[PAD]", "[UNK]", "[CLS]", "[SEP]", *WORDS, *letters, *(f"##{c}" for c in letters)]
    vocabulary = {piece: i for i, piece in enumerate(dict.fromkeys(pieces))}
    tokenizer = Tokenizer(WordPiece(vocabulary, unk_token="[UNK]"))
    tokenizer.normalizer = BertNormalizer()
    tokenizer.pre_tokenizer = BertPreTokenizer()
    tokenizer.post_processor = TemplateProcessing(
        single="[CLS] $A [SEP]", special_tokens=[(token, vocabulary[token]) for token in ("[CLS]", "[SEP]")]
    )
    tokenizer.enable_truncation(32)
    config = LanguageConfig(
        vocabulary=len(vocabulary),
        width=width,
        layers=layers,
        heads=2,
        feedforward=2 * width,
        max_tokens=40,
        segments=0,
        norm_epsilon=1e-12,
    )
    network = LanguageNetwork(config).eval().requires_grad_(False)
    return LanguageModel("tiny", network, tokenizer, max_tokens=32)


def tiny_network(features: int, token_features: int = 16, latent: int = 24) -> TMR:
    """A TMR of random weights with every option in use."""
    sizes = {"width": 16, "layers": 2, "heads": 2, "feedforward": 24}
    config = TMRConfig(
        motion=TransformerConfig(features=features, frames_per_token=4, **sizes),
        text=TransformerConfig(features=token_features, sentence_head=20, **sizes),
        decoder=TransformerConfig(features=features, frames_per_token=4, **sizes),
        latent=latent,
    )
    return TMR(config).eval().requires_grad_(False)


def write(folder: Path, seed: int = 0) -> Path:
    """Write the tiny bundle."""
    torch.manual_seed(seed)
    kind = FEATURE_KINDS["body"]
    language = tiny_language()
    network = tiny_network(kind.size)
    return export_bundle(
        folder,
        name="tiny",
        motion_encoder=network.motion_encoder,
        text_encoder=network.text_encoder,
        language=language,
        mean=np.zeros(kind.size, np.float32),
        std=np.ones(kind.size, np.float32),
        feature_kind=kind.name,
        max_frames=100,
        training={"note": "random weights, for tests"},
    )


if __name__ == "__main__":
    print(write(FOLDER))
