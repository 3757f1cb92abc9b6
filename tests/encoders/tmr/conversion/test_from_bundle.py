"""A bundle becomes a trainable model again that gives the same vectors."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

torch = pytest.importorskip("torch")
pytest.importorskip("onnx")
pytestmark = pytest.mark.torch

from encoders.bundle.bundle import Bundle  # noqa: E402
from encoders.errors import BundleError  # noqa: E402
from encoders.features.registry import FEATURE_KINDS  # noqa: E402
from encoders.tmr.conversion.from_bundle import restore  # noqa: E402
from encoders.tmr.conversion.to_bundle import export_bundle  # noqa: E402
from encoders.tmr.model.network import TMR, TMRConfig, TransformerConfig  # noqa: E402
from encoders.tmr.model.padding import pad  # noqa: E402
from encoders.tmr.training.recipe import default_network  # noqa: E402
from tests.encoders.tiny_bundle import tiny_language  # noqa: E402

KIND = FEATURE_KINDS["body"]
CONFIG = TMRConfig(
    motion=TransformerConfig(KIND.size, width=24, layers=2, heads=3, feedforward=100, frames_per_token=4),
    text=TransformerConfig(64, width=32, layers=1, heads=2, feedforward=64, sentence_head=48),
    decoder=None,
    latent=20,
)


def exported(folder: Path, weights: str, config: TMRConfig = CONFIG) -> tuple[TMR, Bundle]:
    torch.manual_seed(0)
    model = TMR(config).eval()
    rng = np.random.default_rng(0)
    export_bundle(
        folder,
        name="tiny",
        motion_encoder=model.motion_encoder,
        text_encoder=model.text_encoder,
        language=tiny_language(width=64),
        mean=rng.normal(size=KIND.size).astype(np.float32),
        std=rng.uniform(0.1, 2, KIND.size).astype(np.float32),
        feature_kind=KIND.name,
        max_frames=40,
        weights=weights,
    )
    return model, Bundle.load(folder)


@pytest.mark.parametrize(("weights", "tolerance"), [("float32", 1e-6), ("int8", 2e-2)])
def test_every_weight_comes_back(tmp_path: Path, weights: str, tolerance: float) -> None:
    model, _ = exported(tmp_path / "bundle", weights)
    again, _ = restore(tmp_path / "bundle", CONFIG)
    for name, value in model.state_dict().items():
        torch.testing.assert_close(again.state_dict()[name], value, rtol=0, atol=tolerance, msg=name)


def test_motions_lie_where_the_bundle_puts_them(tmp_path: Path) -> None:
    _, bundle = exported(tmp_path / "bundle", "int8")
    model, normaliser = restore(tmp_path / "bundle", CONFIG)
    features = [np.random.default_rng(i).normal(size=(12 + i, KIND.size)).astype(np.float32) for i in range(3)]
    x, mask = pad([(f - normaliser.mean) / normaliser.std for f in features])
    latent = torch.nn.functional.normalize(model.eval().motion_encoder.mean(x, mask), dim=-1).detach().numpy()
    # Where the processor multiplies in int8, what is multiplied is rounded to 8 bits, too.
    np.testing.assert_allclose(latent, bundle.encode_features(features), rtol=0, atol=5e-3)


def test_a_gist_that_the_bundle_lacks_begins_anew(tmp_path: Path) -> None:
    plain = replace(CONFIG, text=replace(CONFIG.text, sentence_head=0))
    torch.manual_seed(1)
    exported(tmp_path / "bundle", "float32", plain)
    model, _ = restore(tmp_path / "bundle", CONFIG)
    assert model.text_encoder.sentence_head is not None
    again, _ = restore(tmp_path / "bundle", plain)
    for name, value in again.state_dict().items():
        assert torch.equal(model.state_dict()[name], value)


def test_the_shipped_bundle_can_be_gone_on_from() -> None:
    model, normaliser = restore(Bundle.load().folder, default_network())
    assert model.motion_decoder is None
    assert normaliser.mean.shape == normaliser.std.shape == (KIND.size,)


def test_networks_of_other_sizes_are_refused(tmp_path: Path) -> None:
    exported(tmp_path / "bundle", "int8")
    for config in (replace(CONFIG.text, layers=3), replace(CONFIG.text, feedforward=66)):
        with pytest.raises(BundleError, match="of these sizes"):
            restore(tmp_path / "bundle", replace(CONFIG, text=config))


def test_a_missing_or_damaged_bundle_is_refused(tmp_path: Path) -> None:
    exported(tmp_path / "bundle", "int8")
    with (tmp_path / "bundle" / "motion.onnx").open("ab") as graph:
        graph.write(b"x")
    with pytest.raises(BundleError, match="damaged"):
        restore(tmp_path / "bundle", CONFIG)
    with pytest.raises(BundleError, match="no model bundle here"):
        restore(tmp_path / "nowhere", CONFIG)
