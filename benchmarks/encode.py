"""How much faster the bundle encodes motions than the plain way: `python -m benchmarks.encode` (needs torch).

The plain way is torch's own fp32 `nn.TransformerEncoder`, as published TMR uses it: batches of 32 clips in file
order, padded to the longest. Ours is `Bundle.encode_features`, whose weights are stored as int8. Both encode the same
clips of 2 to 10 s with the same weights in one run, in turns, on the same number of threads; the best of several
rounds counts. CPU time is compared as well: on a busy machine it says more. Two encoders are timed: published TMR's
sizes, and the default bundle's.
"""

from __future__ import annotations

import argparse
import tempfile
import time
import warnings
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import torch
import torch.nn.functional as F
from numpy.typing import NDArray
from tokenizers import Tokenizer
from tokenizers.models import WordLevel
from torch import Tensor, nn

from encoders.bundle.batching import pad
from encoders.bundle.bundle import Bundle
from encoders.features.registry import FEATURE_KINDS
from encoders.tmr.conversion.to_bundle import export_bundle
from encoders.tmr.model.network import (
    TMR,
    TMRConfig,
    TransformerConfig,
    TransformerEncoder,
    group_frames,
    positions,
    valid_mask,
)
from encoders.tmr.text.language_model import LanguageConfig, LanguageModel, LanguageNetwork
from encoders.tmr.training.recipe import default_network

Array = NDArray[np.float32]
Encode = Callable[[Sequence[Array]], Array]

PUBLISHED = TMRConfig(decoder=None)


def plain(encoder: TransformerEncoder) -> Encode:
    """The encoder's weights in torch's own layers, used as published code uses them."""
    config = encoder.config
    layer = nn.TransformerEncoderLayer(
        config.width, config.heads, config.feedforward, config.dropout, "gelu", batch_first=True
    )
    stack = nn.TransformerEncoder(layer, config.layers).eval()
    stack.load_state_dict(encoder.seqTransEncoder.state_dict())

    def batch(clips: Sequence[Array]) -> Tensor:
        padded, lengths = pad(clips)
        x, mask = torch.from_numpy(padded), valid_mask(torch.from_numpy(lengths), padded.shape[1])
        x, mask = group_frames(x, mask, config.frames_per_token)
        tokens = torch.cat((encoder.tokens.expand(len(x), -1, -1), encoder.projection(x)), dim=1)
        tokens = tokens + positions(tokens.shape[1], config.width)
        out = stack(tokens, src_key_padding_mask=~F.pad(mask, (2, 0), value=True))
        return F.normalize(encoder.to_latent(out[:, 0]), dim=-1)

    def encode(clips: Sequence[Array]) -> Array:
        with torch.inference_mode():
            batches = [batch(clips[first : first + 32]) for first in range(0, len(clips), 32)]
            return torch.cat(batches).numpy()

    return encode


def bundle_of(encoder: TransformerEncoder, kind: str, folder: Path, threads: int) -> Bundle:
    """A bundle around a motion encoder; its text side is a stub."""
    sizes = LanguageConfig(
        vocabulary=8, width=8, layers=1, heads=1, feedforward=8, max_tokens=8, segments=0, norm_epsilon=1e-12
    )
    tokenizer = Tokenizer(WordLevel({"[UNK]": 0}, unk_token="[UNK]"))
    language = LanguageModel("stub", LanguageNetwork(sizes), tokenizer, max_tokens=8)
    text = TransformerConfig(8, width=8, layers=1, heads=1, feedforward=8)
    size = FEATURE_KINDS[kind].size
    export_bundle(
        folder,
        name="benchmark",
        motion_encoder=encoder,
        text_encoder=TransformerEncoder(text, encoder.latent),
        language=language,
        mean=np.zeros(size, np.float32),
        std=np.ones(size, np.float32),
        feature_kind=kind,
        max_frames=round(10 * FEATURE_KINDS[kind].fps),
    )
    return Bundle.load(folder, threads=threads)


def compare(name: str, encoder: TransformerEncoder, kind: str, *, clips: int, threads: int, rounds: int) -> float:
    """Time both ways in turns; print and return how many times as fast the bundle is."""
    fps, size = FEATURE_KINDS[kind].fps, FEATURE_KINDS[kind].size
    rng = np.random.default_rng(0)
    lengths = rng.integers(round(2 * fps), round(10 * fps) + 1, clips)
    features = [rng.standard_normal((length, size), dtype=np.float32) for length in lengths]
    with tempfile.TemporaryDirectory() as folder:
        ways = {
            "plain": plain(encoder.eval()),
            "bundle": bundle_of(encoder, kind, Path(folder) / "bundle", threads).encode_features,
        }
        latents = {way: encode(features) for way, encode in ways.items()}
        cosine = float((latents["plain"] * latents["bundle"]).sum(axis=1).min())
        wall: dict[str, list[float]] = {way: [] for way in ways}
        cpu: dict[str, list[float]] = {way: [] for way in ways}
        for _ in range(rounds):
            for way, encode in ways.items():
                start, start_cpu = time.perf_counter(), time.process_time()
                encode(features)
                wall[way].append(time.perf_counter() - start)
                cpu[way].append(time.process_time() - start_cpu)
    ratio, cpu_ratio = (min(times["plain"]) / min(times["bundle"]) for times in (wall, cpu))
    rates = ", ".join(f"{way} {clips / min(times):.0f} clips/s" for way, times in wall.items())
    print(f"{name}: {rates}: {ratio:.2f} times as fast ({cpu_ratio:.2f} by CPU time), cosine at least {cosine:.5f}")
    return ratio


def main() -> None:
    """Print both comparisons."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--clips", type=int, default=256)
    parser.add_argument("--threads", type=int, default=torch.get_num_threads())
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    torch.set_num_threads(options.threads)
    torch.manual_seed(0)
    warnings.simplefilter("ignore")  # torch's nested tensors announce that they may change
    print(f"{options.clips} clips of 2 to 10 s, {options.threads} threads, best of {options.rounds}")
    published = TMR(PUBLISHED).motion_encoder
    compare("published TMR", published, "humanml3d", **vars(options))
    default = TMR(default_network(FEATURE_KINDS["body"].size, 384)).motion_encoder
    compare("default bundle", default, "body", **vars(options))


if __name__ == "__main__":
    main()
