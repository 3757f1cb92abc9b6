"""The tokenizer of a bundle, out of a file that somebody else may have crafted."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from encoders.errors import BundleError

if TYPE_CHECKING:
    from tokenizers import Tokenizer

#: Bytes of the largest file, and tokens of the longest sentence.
LARGEST, MOST_TOKENS = 64 << 20, 512

#: Steps of a tokenizer whose work grows with the sentence and with nothing else: none replaces or matches patterns.
_STEPS = {
    "normalizer": "BertNormalizer Lowercase NFC NFD NFKC NFKD Nmt Sequence Strip StripAccents",
    "pre_tokenizer": "BertPreTokenizer ByteLevel Digits Metaspace Punctuation Sequence Whitespace WhitespaceSplit",
    "post_processor": "BertProcessing ByteLevel RobertaProcessing Sequence TemplateProcessing",
    "model": "BPE Unigram WordLevel WordPiece",
}
_PARTS = ("normalizers", "pretokenizers", "processors")


def read_tokenizer(path: Path) -> Tokenizer:
    """Read and check a tokenizer; it truncates at `MOST_TOKENS` at the latest, and pads nothing.

    Raises
    ------
    BundleError
        If the file is no tokenizer, too large, or has steps that are not needed for sentences.
    """
    from tokenizers import Tokenizer

    try:
        if path.stat().st_size > LARGEST:
            raise ValueError(f"larger than {LARGEST >> 20} MB")
        text = path.read_text("utf-8")
        document = json.loads(text)
        for name, known in _STEPS.items():
            for kind in _kinds(document.get(name)):
                if kind not in known.split():
                    raise ValueError(f"{name} {kind!r}, which no sentence needs")
        tokenizer = Tokenizer.from_str(text)
    except Exception as error:  # tokenizers raises plain Exception
        raise BundleError(f"{path}: cannot be read ({type(error).__name__}: {str(error)[:500]})") from error
    tokenizer.no_padding()
    stated = (tokenizer.truncation or {}).get("max_length", MOST_TOKENS)
    tokenizer.enable_truncation(min(stated, MOST_TOKENS))
    return tokenizer


def _kinds(step: Any) -> list[Any]:
    """The type of a step and of all steps within it."""
    if step is None:
        return []
    if not isinstance(step, dict):
        return [step]
    inner = [part for name in _PARTS for part in step.get(name) or []]
    return [step.get("type"), *(kind for part in inner for kind in _kinds(part))]
