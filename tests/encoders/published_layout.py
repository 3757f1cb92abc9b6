"""Small things in the layouts in which others publish them: a TMR run, its statistics, a DistilBERT. Needs torch.

    models/tmr_small/config.json, last_weights/*.pt or logs/checkpoints/last.ckpt
    stats/humanml3d/guoh3dfeats/mean.pt, std.pt
    distilbert-base-uncased/config.json, model.safetensors, tokenizer.json

The run is the published code's own of reduced sizes, out of the excerpts in tests/data; the rest is of random numbers.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import torch

from encoders.tmr.conversion.from_published import read_config
from encoders.tmr.model.network import TMR
from encoders.tmr.text.language_model import LanguageNetwork
from tests.conftest import ROOT
from tests.encoders.tiny_bundle import tiny_language

DATA = ROOT / "tests" / "data"
STATISTICS = "stats/humanml3d/guoh3dfeats"


def write_run(run: Path, *, as_checkpoint: bool = False, **changes: object) -> Path:
    """Write the published run, as weights by module or as a Lightning checkpoint.

    Parameters
    ----------
    changes : values of config.json by the path to them, such as ``model__motion_encoder__ff_size``
    """
    run.mkdir(parents=True)
    (run / "config.json").write_text(json.dumps(config()))
    tensors = {
        "motion_decoder": TMR(read_config(run)).motion_decoder.state_dict(),
        **{module: {} for module in ("motion_encoder", "text_encoder")},
    }
    with np.load(DATA / "published_encoders.npz", allow_pickle=False) as arrays:
        for key, values in arrays.items():
            module, name = key.split("/")
            tensors[module][name] = torch.from_numpy(values.astype(np.float32))
    if as_checkpoint:
        (run / "logs" / "checkpoints").mkdir(parents=True)
        state = {f"{module}.{name}": value for module, values in tensors.items() for name, value in values.items()}
        torch.save({"epoch": 1, "state_dict": state, "loops": {}}, run / "logs" / "checkpoints" / "last.ckpt")
    else:
        (run / "last_weights").mkdir()
        for module, values in tensors.items():
            torch.save(values, run / "last_weights" / f"{module}.pt")
    changed = config()
    for path, value in changes.items():
        *parents, last = path.split("__")
        inner = changed
        for name in parents:
            inner = inner[name]
        inner[last] = value
    (run / "config.json").write_text(json.dumps(changed))
    return run


def config() -> dict:
    """The configuration as the published code writes it, without what only training reads."""
    return json.loads((DATA / "published_config.json").read_text()) | {
        "data": {
            "motion_loader": {
                "base_dir": "datasets/motions/guoh3dfeats",
                "normalizer": {"base_dir": STATISTICS, "eps": 1e-12},
                "fps": 20.0,
                "nfeats": 263,
            },
            "text_to_token_emb": {"modelname": "distilbert-base-uncased"},
        }
    }


def write_statistics(folder: Path, size: int = 263) -> tuple[np.ndarray, np.ndarray]:
    """Write statistics of random numbers; mean and standard deviation."""
    rng = np.random.default_rng(0)
    mean = rng.normal(scale=0.1, size=size).astype(np.float32)
    std = rng.uniform(0.5, 2, size).astype(np.float32)
    folder.mkdir(parents=True, exist_ok=True)
    for name, values in (("mean", mean), ("std", std)):
        torch.save(torch.from_numpy(values), folder / f"{name}.pt")
    return mean, std


def write_language(folder: Path, width: int = 768) -> Path:
    """Write a DistilBERT of one layer of random weights that knows a few words and all letters."""
    from safetensors.torch import save_file

    torch.manual_seed(1)
    model = tiny_language(width)
    sizes = model.network.config
    values = {
        "model_type": "distilbert",
        "vocab_size": sizes.vocabulary,
        "dim": sizes.width,
        "n_layers": sizes.layers,
        "n_heads": sizes.heads,
        "hidden_dim": sizes.feedforward,
        "max_position_embeddings": sizes.max_tokens,
    }
    folder.mkdir(parents=True)
    (folder / "config.json").write_text(json.dumps(values))
    (folder / "tokenizer.json").write_text(model.tokenizer.to_str())
    save_file(published_names(model.network, "distilbert"), folder / "model.safetensors")
    return folder


def published_names(network: LanguageNetwork, kind: str) -> dict:
    """The network's tensors as BERT's or DistilBERT's authors name them."""
    bert = {
        "word_embeddings.": "embeddings.word_embeddings.",
        "position_embeddings.": "embeddings.position_embeddings.",
        "norm.": "embeddings.LayerNorm.",
        "layers.": "encoder.layer.",
        "q_lin": "attention.self.query",
        "k_lin": "attention.self.key",
        "v_lin": "attention.self.value",
        "out_lin": "attention.output.dense",
        "sa_layer_norm": "attention.output.LayerNorm",
        "lin1": "intermediate.dense",
        "lin2": "output.dense",
        "output_layer_norm": "output.LayerNorm",
    }
    distilbert = {name: new for name, new in bert.items() if name[-1] == "."} | {
        "layers.": "transformer.layer.",
        **{f"{x}_lin": f"attention.{x}_lin" for x in ("q", "k", "v", "out")},
        "lin1": "ffn.lin1",
        "lin2": "ffn.lin2",
    }
    names = bert if kind == "bert" else distilbert
    tensors = {}
    for name, tensor in network.state_dict().items():
        parts = name.split(".")
        head = names[f"{parts[0]}."]
        module = names.get(parts[2], parts[2]) if parts[0] == "layers" else ""
        tensors[f"{head}{parts[1]}.{module}.{parts[3]}" if module else f"{head}{parts[1]}"] = tensor.contiguous()
    return tensors
