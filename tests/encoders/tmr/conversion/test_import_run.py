"""A published run becomes a bundle with the published vectors; what does not fit is told apart by name."""

from __future__ import annotations

import json
import shutil
import warnings

import numpy as np
import pytest

torch = pytest.importorskip("torch")
onnx = pytest.importorskip("onnx")
pytest.importorskip("safetensors")
pytestmark = pytest.mark.torch

from encoders.bundle.bundle import Bundle  # noqa: E402
from encoders.errors import BundleError, MotionSeekWarning  # noqa: E402
from encoders.motion import Motion  # noqa: E402
from encoders.tmr.conversion.from_published import MODULES, load_run, read_config  # noqa: E402
from encoders.tmr.conversion.import_run import import_run  # noqa: E402
from encoders.tmr.model.network import TMR, TMRConfig  # noqa: E402
from encoders.tmr.text.language_model import LanguageModel  # noqa: E402
from tests.encoders.published_layout import (  # noqa: E402
    DATA,
    STATISTICS,
    config,
    write_language,
    write_run,
    write_statistics,
)

CLOSE = {"rtol": 0, "atol": 1e-4}


@pytest.fixture(scope="module")
def published(tmp_path_factory):
    """A folder as the published repository is, with a run and its statistics; and a language model."""
    root = tmp_path_factory.mktemp("published")
    write_run(root / "models" / "tmr_small")
    write_statistics(root / STATISTICS)
    write_language(root / "distilbert-base-uncased")
    return root


@pytest.fixture(scope="module")
def imported(published, tmp_path_factory):
    folder = tmp_path_factory.mktemp("models") / "small"
    bundle, difference = import_small(published / "models" / "tmr_small", folder, published)
    assert difference < 1e-5
    return bundle


def import_small(run, folder, published, **options):
    return import_run(
        run, folder, name="small", **{"language_model": str(published / "distilbert-base-uncased")} | options
    )


@pytest.fixture(scope="module")
def expected():
    with np.load(DATA / "published_losses.npz", allow_pickle=False) as arrays:
        return dict(arrays)


def unit(rows):
    return rows / np.linalg.norm(rows, axis=1, keepdims=True)


def test_the_bundle_gives_the_published_vectors_of_motions(imported, published, expected):
    mean, std = (torch.load(published / STATISTICS / f"{name}.pt").numpy() for name in ("mean", "std"))
    motions = [x[mask] * std + mean for x, mask in zip(expected["motion/x"], expected["motion/mask"], strict=True)]
    np.testing.assert_allclose(imported.encode_features(motions), unit(expected["dist/m_mu"][: len(motions)]), **CLOSE)


def test_its_text_encoder_gives_the_published_vectors_of_token_features(imported, expected, tmp_path):
    """The graph from where the language model ends, fed with the token features of the published code."""
    graph = onnx.load(imported.folder / "text.onnx").graph
    shapes = {one.name: list(one.dims) for one in graph.initializer}
    makers = {output: node for node in graph.node for output in node.output}
    projection = next(node for node in graph.node if node.op_type == "Gemm" and shapes[node.input[1]] == [64, 768])
    tokens = makers[projection.input[0]].input[0]
    part = tmp_path / "part.onnx"
    onnx.utils.extract_model(
        str(imported.folder / "text.onnx"), str(part), [tokens, "input_ids", "attention_mask"],
        [graph.output[0].name], check_model=False, infer_shapes=True,
    )  # fmt: skip
    import onnxruntime

    mask = expected["text/mask"].astype(np.int64)
    feed = {tokens: expected["text/x"].astype(np.float32), "input_ids": mask, "attention_mask": mask}
    session = onnxruntime.InferenceSession(part)
    (latents,) = session.run(None, {node.name: feed[node.name] for node in session.get_inputs()})
    np.testing.assert_allclose(latents, expected["dist/t_mu"][: len(mask)], **CLOSE)


def test_sentences_go_through_the_runs_own_language_model_and_text_encoder(imported, published):
    sentences = ["a person walks", "a man sits down slowly and then stands up", "Jumps", "a " * 60]
    network = load_run(published / "models" / "tmr_small")
    language = LanguageModel.load(published / "distilbert-base-uncased", max_tokens=None)
    assert language.max_tokens == 40  # as many as it has positions for
    rows = [
        network.text_encoder.mean(torch.from_numpy(tokens)[None], torch.ones(1, len(tokens), dtype=torch.bool))[0]
        for tokens in language.token_features(sentences)
    ]
    np.testing.assert_allclose(imported.encode_texts(sentences), unit(torch.stack(rows).numpy()), **CLOSE)


def test_the_manifest_says_what_it_is(imported):
    assert (imported.name, imported.feature_kind, imported.fps, imported.latent_size) == ("small", "humanml3d", 20, 64)
    assert imported.manifest["language_model"] == "distilbert-base-uncased"
    assert imported.manifest["training"]["imported"] == "tmr_small"
    assert imported.max_frames == 2000


def test_a_checkpoint_gives_the_same_bundle(published, imported, tmp_path):
    run = write_run(tmp_path / "run", as_checkpoint=True)
    shutil.move(run / "logs" / "checkpoints" / "last.ckpt", run / "logs" / "checkpoints" / "latest-epoch=9.ckpt")
    shutil.copy(run / "logs" / "checkpoints" / "latest-epoch=9.ckpt", run / "logs" / "checkpoints" / "epoch=10.ckpt")
    (run / "logs" / "checkpoints" / "latest-epoch=9.ckpt").write_bytes(b"an older one")
    bundle, _ = import_small(run, tmp_path / "bundle", published, stats=published / STATISTICS)
    assert bundle.fingerprint == imported.fingerprint


def test_the_vectors_of_the_whole_published_run(golden, published, tmp_path):
    run, data = golden / "published_run", golden / "published_dataset"
    with warnings.catch_warnings():
        warnings.simplefilter("error", MotionSeekWarning)  # human movement fits the published statistics
        bundle, _ = import_small(run, tmp_path / "bundle", published, stats=data / STATISTICS)
    annotations = json.loads((data / "annotations/humanml3d/annotations.json").read_text())
    rows = json.loads((run / "latents/humanml3d_keyids_index_all.json").read_text())
    motions = []
    for key in rows:
        first = annotations[key]["annotations"][0]
        features = np.load(data / "motions/guoh3dfeats" / f"{annotations[key]['path']}.npy").astype(np.float32)
        motions.append(features[int(first["start"] * 20) : int(first["end"] * 20)])
    published_rows = np.load(run / "latents/humanml3d_all_unit.npy")[list(rows.values())]
    np.testing.assert_allclose(bundle.encode_features(motions), published_rows, **CLOSE)


@pytest.mark.slow
def test_a_run_of_the_published_sizes_is_imported(published, tmp_path):
    torch.manual_seed(0)
    network = TMR(TMRConfig())
    run = tmp_path / "run"
    (run / "last_weights").mkdir(parents=True)
    full = config()
    for module in MODULES:
        full["model"][module] |= {"latent_dim": 256, "ff_size": 1024, "num_layers": 6}
        torch.save(getattr(network, module).state_dict(), run / "last_weights" / f"{module}.pt")
    (run / "config.json").write_text(json.dumps(full))
    bundle, difference = import_small(run, tmp_path / "bundle", published, stats=published / STATISTICS)
    assert bundle.latent_size == 256
    assert difference < 1e-5


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"model__motion_encoder__ff_size": 96}, "motion_encoder.pt: does not fit .*linear1.weight"),
        ({"model__motion_encoder__num_layers": 3}, "motion_encoder.pt: does not fit .*layers.2"),
        ({"model__text_encoder__latent_dim": 32}, "config.json: .*latent_dim differs"),
        ({"model__text_encoder__activation": "relu"}, "config.json: .*only gelu"),
        ({"model__motion_encoder__vae": False}, "config.json: .*vae"),
        ({"model": []}, "config.json: not the configuration"),
        ({"data": {}}, "config.json: not the configuration of a TMR run .*'motion_loader' is missing"),
        ({"model__motion_encoder__nfeats": 251}, r"config.json: \[251, 263\] numbers a frame, .*have 263"),
        ({"data__motion_loader__fps": 12.5}, "config.json: trained at 12.5 frames a second, .* have 20"),
        ({"data__motion_loader__base_dir": "datasets/motions/smplrifke"}, "trained on 'smplrifke', .*not known here"),
        ({"data__motion_loader__normalizer__base_dir": "stats/kitml/x"}, "stats/kitml/x are neither .*--stats"),
        ({"data__text_to_token_emb__modelname": "bert-base-uncased"}, "not bert-base-uncased, .* it is DistilBERT"),
        ({"data__text_to_token_emb__modelname": "distilbert-base-cased"}, "it does not tell capital letters apart"),
    ],
)
def test_a_configuration_that_does_not_fit_is_named(published, tmp_path, changes, message):
    run = write_run(tmp_path / "run", **changes)
    shutil.copytree(published / STATISTICS, tmp_path / STATISTICS)
    with pytest.raises(BundleError, match=message):
        import_small(run, tmp_path / "bundle", published)
    assert not (tmp_path / "bundle").exists()


def damage_weights(run, module="text_encoder", name="tokens", value=float("nan")):
    path = run / "last_weights" / f"{module}.pt"
    tensors = torch.load(path)
    tensors[name] = torch.full_like(tensors[name], value) if value is not None else tensors.pop(name)[:1]
    torch.save(tensors, path)


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (lambda root: damage_weights(root / "run"), "text_encoder.tokens has numbers that are not finite"),
        (lambda root: damage_weights(root / "run", value=None), "text_encoder.pt: does not fit"),
        (lambda root: (root / "run/config.json").unlink(), "config.json: missing"),
        (lambda root: (root / "run/last_weights/text_encoder.pt").unlink(), "text_encoder.pt: missing, and .*no check"),
        (lambda root: (root / "run/last_weights/text_encoder.pt").write_bytes(b"x"), "no tensors that can be read"),
        (lambda root: (root / STATISTICS / "std.pt").unlink(), "no std.pt here"),
        (lambda root: write_statistics(root / STATISTICS, 251), r"mean has the shape \(251,\), not 263 numbers"),
        (lambda root: torch.save(torch.zeros(263), root / STATISTICS / "std.pt"), "std is not positive for feature 0"),
        (lambda root: torch.save(torch.full((263,), torch.inf), root / STATISTICS / "mean.pt"), "mean .*not finite"),
        (lambda root: torch.save([1.0], root / STATISTICS / "mean.pt"), "holds list, not a tensor"),
        (lambda root: (root / "language/model.safetensors").write_bytes(b"x"), "no language model that can be read"),
        (lambda root: (root / "language/tokenizer.json").unlink(), "no language model that can be read .*vocab.txt"),
    ],
)
def test_a_file_that_is_damaged_or_missing_is_named(published, tmp_path, damage, message):
    write_run(tmp_path / "run")
    shutil.copytree(published / STATISTICS, tmp_path / STATISTICS)
    shutil.copytree(published / "distilbert-base-uncased", tmp_path / "language")
    damage(tmp_path)
    with pytest.raises(BundleError, match=message):
        import_small(tmp_path / "run", tmp_path / "bundle", published, language_model=str(tmp_path / "language"))


def test_another_language_model_is_refused(published, tmp_path):
    run = published / "models" / "tmr_small"
    small = write_language(tmp_path / "distilbert-base-uncased", width=16)
    with pytest.raises(BundleError, match="its tokens have 16 numbers, the run reads 768"):
        import_small(run, tmp_path / "bundle", published, language_model=str(small))
    with pytest.raises(BundleError, match="trained with the language model distilbert-base-uncased, not with roberta"):
        import_small(run, tmp_path / "bundle", published, language_model="roberta-base")
    with pytest.raises(BundleError, match="no such folder"):
        import_small(run, tmp_path / "bundle", published, language_model="./nowhere/distilbert-base-uncased")


def test_a_failed_import_leaves_the_model_that_was_there(published, tmp_path):
    bundle, _ = import_small(published / "models" / "tmr_small", tmp_path / "bundle", published)
    run = write_run(tmp_path / "run")
    damage_weights(run)
    with pytest.raises(BundleError):
        import_small(run, tmp_path / "bundle", published, stats=published / STATISTICS)
    assert Bundle.load(tmp_path / "bundle").fingerprint == bundle.fingerprint
    assert sorted(path.name for path in tmp_path.iterdir()) == ["bundle", "run"]


def test_statistics_that_no_human_movement_fits_are_warned_of(published, tmp_path):
    write_statistics(tmp_path)
    mean = torch.load(tmp_path / "mean.pt")
    mean[7] += 40  # as where Y and Z are exchanged
    torch.save(mean, tmp_path / "mean.pt")
    with pytest.warns(MotionSeekWarning, match="feature 7 of human movement lies"):
        import_small(published / "models" / "tmr_small", tmp_path / "bundle", published, stats=tmp_path)


def test_a_run_without_its_decoder_is_imported(published, imported, tmp_path):
    run = write_run(tmp_path / "run")
    (run / "last_weights" / "motion_decoder.pt").unlink()
    assert load_run(run).motion_decoder is None
    bundle, _ = import_small(run, tmp_path / "bundle", published, stats=published / STATISTICS)
    assert bundle.fingerprint == imported.fingerprint


@pytest.mark.parametrize(("stated", "features"), [("rifke", None), ("joints-of-ours", "rifke")])
def test_a_run_on_another_kind_of_features_is_imported(published, tmp_path, stated, features):
    torch.manual_seed(0)
    run = write_run(
        tmp_path / "run",
        data__motion_loader__base_dir=f"datasets/motions/{stated}",
        data__motion_loader__fps=12.5,
        data__motion_loader__nfeats=67,
        model__motion_encoder__nfeats=67,
        model__motion_decoder__nfeats=67,
    )
    network = TMR(read_config(run))
    for module in MODULES:
        torch.save(getattr(network, module).state_dict(), run / "last_weights" / f"{module}.pt")
    write_statistics(tmp_path / "stats", 67)
    bundle, _ = import_small(run, tmp_path / "bundle", published, stats=tmp_path / "stats", features=features)
    motion = Motion(np.random.default_rng(0).normal(size=(40, 22, 3)))
    assert (bundle.feature_kind, bundle.fps, bundle.features(motion).shape) == ("rifke", 12.5, (25, 67))
    assert bundle.encode_motions([motion]).shape == (1, 64)
