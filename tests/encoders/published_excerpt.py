"""Write the excerpts of the published code's numbers that lie in tests/data.

    python -m tests.encoders.published_excerpt ../shared/fixtures

The numbers were made by running the published code of HumanML3D and TMR on synthetic motion. Weights and token features
are float16 numbers, and stored as such.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import torch

OUT = Path(__file__).resolve().parent.parent / "data"
ITEMS = 3  # motions and sentences whose Gaussians are compared
LARGEST = 40  # similarity matrices
ENCODERS = ("motion_encoder", "text_encoder")


def weights(run: Path) -> None:
    """The encoders of the published run, and the part of its configuration that states the networks."""
    tensors = {
        f"{module}/{name}": tensor.numpy().astype(np.float16)
        for module in ENCODERS
        for name, tensor in torch.load(run / "last_weights" / f"{module}.pt", weights_only=True).items()
    }
    np.savez_compressed(OUT / "published_encoders.npz", **tensors)
    config = json.loads((run / "config.json").read_text())
    (OUT / "published_config.json").write_text(json.dumps({"model": config["model"]}, indent=1) + "\n")


def losses(golden: Path) -> None:
    """A few inputs with their Gaussians, all latents, and what the losses of these are."""
    with np.load(golden / "losses_in.npz") as arrays:
        kept = {name: arrays[name] for name in arrays if name.startswith(("dist/", "sample_mean/", "sampled/"))}
        kept |= {name: arrays[name][:ITEMS] for name in ("motion/x", "motion/mask", "text/mask")}
        kept |= {"text/x": arrays["text/x"][:ITEMS].astype(np.float16), "sent_emb": arrays["sent_emb"]}
        assert np.array_equal(kept["text/x"].astype(np.float32), arrays["text/x"][:ITEMS])
    np.savez_compressed(OUT / "published_losses.npz", **kept)
    expected = json.loads((golden / "losses_out.json").read_text())
    names = (
        "sample_mean", "sampled", "kl_terms", "infonce_on_sample_mean_latents", "infonce_all_texts_identical_0.8",
        "masked_pairs_threshold_0.8",
    )  # fmt: skip
    (OUT / "published_losses.json").write_text(json.dumps({name: expected[name] for name in names}) + "\n")


def retrieval(golden: Path) -> None:
    """Small similarity matrices and their metrics."""
    cases = json.loads((golden / "retrieval_metrics_cases.json").read_text())
    kept = {
        name: case["metrics_unrounded"]
        for name, case in cases.items()
        if "metrics_unrounded" in case and not case["has_emb"] and case["n"] <= LARGEST
    }
    with np.load(golden / "retrieval_metrics_cases.npz") as arrays:
        np.savez_compressed(OUT / "published_retrieval.npz", **{name: arrays[f"{name}/sim"] for name in kept})
    (OUT / "published_retrieval.json").write_text(json.dumps(kept) + "\n")


def protocols(golden: Path) -> None:
    """The similarities of the published run on its test split, and its metrics of the four protocols."""
    with np.load(golden / "retrieval_metrics_run.npz") as arrays:
        keys, sentences = arrays["normal/keyids"].tolist(), arrays["normal/sent_emb"]
        similar = sentences @ sentences.T > 0.9
        subset = [keys.index(key) for key in arrays["nsim/keyids"]]
        kept = {"similarity": arrays["normal/sim"], "similar": similar, "keys": arrays["normal/keyids"]}
    np.savez_compressed(OUT / "published_protocols.npz", **kept, subset=np.array(subset))
    items = json.loads((golden / "published_dataset_items.json").read_text())["test"]
    wanted = json.loads((golden / "retrieval_metrics_run.json").read_text())
    assert [item["keyid"] for item in items] == keys
    document = {"captions": [item["text"] for item in items], "metrics": wanted}
    (OUT / "published_protocols.json").write_text(json.dumps(document) + "\n")


def features(golden: Path) -> None:
    """The special cases: three frames, mirroring, exactly opposite bones; some rows of each."""
    path = OUT / "humanml3d_features.npz"
    with np.load(path) as arrays:
        kept = dict(arrays)
    with np.load(golden / "humanml3d_features.npz") as arrays:
        kept["DEGENERATE_facing_180_exact/joints"] = arrays["DEGENERATE_facing_180_exact/joints"]
        for name in ("joints", "features_fixed", "features_noretarget_fixed"):
            kept[f"BUGGY_three_frames/{name}"] = arrays[f"BUGGY_three_frames/{name}"]
        for case, name in (
            ("mirror_walk_turn_left_090", "features"),
            ("DEGENERATE_cartwheel_antiparallel", "features_noretarget"),
        ):
            wanted = arrays[f"{case}/{name}"]
            rows = np.unique([*range(0, len(wanted), 8), *np.flatnonzero(~np.isfinite(wanted).all(axis=1))])
            kept |= {
                f"{case}/joints": arrays[f"{case}/joints"], f"{case}/rows": rows, f"{case}/{name}": wanted[rows]
            }  # fmt: skip
    np.savez_compressed(path, **kept)


if __name__ == "__main__":
    source = Path(sys.argv[1])
    weights(source / "published_run")
    losses(source)
    retrieval(source)
    protocols(source)
    features(source)
