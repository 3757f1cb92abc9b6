"""Training: it learns, goes on exactly where it stopped, and knows what is no negative."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from zlib import crc32

import numpy as np
import pytest

torch = pytest.importorskip("torch")
pytestmark = pytest.mark.torch

from encoders.errors import MotionSeekError  # noqa: E402
from encoders.tmr.model.network import TMRConfig, TransformerConfig  # noqa: E402
from encoders.tmr.model.padding import pad  # noqa: E402
from encoders.tmr.training.batches import Batches  # noqa: E402
from encoders.tmr.training.loop import Trainer, learning_rate  # noqa: E402
from encoders.tmr.training.losses import contrastive, hard_negative_loss  # noqa: E402
from encoders.tmr.training.pairs import Pair, PairStore  # noqa: E402
from encoders.tmr.training.pipeline import prepare  # noqa: E402
from encoders.tmr.training.recipe import Recipe  # noqa: E402

KINDS, FEATURES, WIDTH = 8, 6, 8
UNRELATED = ("a cheap spreadsheet", "lorem ipsum")
SMALL = {"width": 16, "layers": 1, "heads": 2, "feedforward": 24, "dropout": 0.0}
RECIPE = Recipe(
    network=TMRConfig(
        motion=TransformerConfig(features=FEATURES, **SMALL),
        text=TransformerConfig(features=WIDTH, **SMALL),
        decoder=TransformerConfig(features=FEATURES, **SMALL),
        latent=12,
    ),
    steps=30,
    batch=16,
    rate=1e-2,
    warmup=5,
    hard_negatives=4,
    unrelated=2,
    decoded=8,
    averaging=0.9,
    yaw=0.0,
    tilt=0.0,
    max_frames=20,
)


class Words:
    """A language model in which every word has a vector of its own."""

    name = "words"

    def token_features(self, sentences: list[str], *, bf16: bool = False) -> list[np.ndarray]:
        return [np.stack([self._vector(word) for word in sentence.split()]) for sentence in sentences]

    @staticmethod
    def _vector(word: str) -> np.ndarray:
        return np.random.default_rng(crc32(word.encode())).normal(size=WIDTH).astype(np.float32)


def made(kind: int, seed: int) -> Pair:
    """A motion that points along its kind, and a sentence that says so; every kind is also a motion."""
    rng = np.random.default_rng(seed)
    axis = np.random.default_rng(kind).normal(size=FEATURES)
    features = axis + 0.1 * rng.normal(size=(int(rng.integers(8, 16)), FEATURES))
    facts = frozenset({"moves", f"kind{kind}"})
    false = (f"kind{(kind + 1) % KINDS}", "")
    return Pair(features, (f"kind{kind}", "moves"), (facts, frozenset({"moves"})), facts, false)


def store(per_kind: int, seed: int) -> PairStore:
    return PairStore(made(kind, seed + KINDS * i + kind) for i in range(per_kind) for kind in range(KINDS))


@pytest.fixture
def prepared(tmp_path: Path):
    return prepare(RECIPE, store(3, 0), None, store(1, 1000), None, UNRELATED, Words(), tmp_path / "cache")


@pytest.mark.slow
def test_it_learns_to_tell_the_motions_of_a_batch_apart(prepared, tmp_path: Path) -> None:
    """Far below the loss of a model to which all motions and sentences are the same."""
    batch = prepared[0].draw(np.random.default_rng(0))
    same = contrastive(torch.ones(len(batch.texts), 2), torch.ones(16, 2), 0.1, batch.ignore)
    knowing_nothing = same.item() + RECIPE.hard_negative_weight * np.log(2)
    batches = SimpleNamespace(draw=lambda rng, hard: batch, embeddings=None)
    Trainer(tmp_path / "run", replace(RECIPE, rate=3e-3), batches).run(every=1, say=str)
    log = (tmp_path / "run" / "log.jsonl").read_text().splitlines()
    losses = [json.loads(row)["contrastive"] for row in log]
    assert losses[0] > 0.9 * knowing_nothing
    assert losses[-1] < 0.6 * knowing_nothing


def test_validation_knows_what_is_true_of_what(prepared, tmp_path: Path) -> None:
    batches, validate, _ = prepared
    figures = validate(Trainer(tmp_path / "run", RECIPE, batches).averaged())
    assert set(figures) == {"synthetic_R@1", "synthetic_R@10", "strict_R@1", "strict_MedR", "hard_negatives"}
    assert figures["synthetic_R@10"] == 100.0, "there are eight motions"
    assert figures["synthetic_R@1"] >= figures["strict_R@1"]


def test_a_run_that_was_stopped_ends_as_one_that_was_not(prepared, tmp_path: Path) -> None:
    """Within the warm-up the rate does not depend on where the run ends."""
    batches, _, _ = prepared
    recipe = replace(RECIPE, steps=8, warmup=100)
    whole = Trainer(tmp_path / "whole", recipe, batches).run(say=str)
    Trainer(tmp_path / "two", replace(recipe, steps=4), batches).run(say=str)
    resumed = Trainer(tmp_path / "two", recipe, batches)
    assert resumed.step == 4
    for name, value in resumed.run(say=str).state_dict().items():
        assert torch.equal(value, whole.state_dict()[name]), name


def test_head_finetuning_changes_the_sentence_head_alone(prepared, tmp_path: Path) -> None:
    batches, _, _ = prepared
    network = replace(RECIPE.network, decoder=None, text=replace(RECIPE.network.text, sentence_head=16))
    recipe = replace(RECIPE, network=network, steps=10, weights=replace(RECIPE.weights, sentence_head=0.0))
    before, after = (
        Trainer(tmp_path / str(steps), replace(recipe, head_steps=steps), batches).run(say=str) for steps in (0, 60)
    )
    changed = {n for n, value in after.state_dict().items() if not torch.equal(value, before.state_dict()[n])}
    assert changed == {n for n in after.state_dict() if ".sentence_head." in n}
    batch = batches.draw(np.random.default_rng(3), hard=False)
    with torch.inference_mode():
        motion = after.motion_encoder.mean(*pad(batch.motions))
        loss = [
            contrastive(m.text_encoder.sentence_head(*pad(batch.texts)), motion, 0.07, batch.ignore)
            for m in (before, after)
        ]
    assert loss[1] < 0.8 * loss[0]


def test_the_head_of_a_finished_run_is_not_finetuned_again(prepared, tmp_path: Path) -> None:
    batches, _, _ = prepared
    network = replace(RECIPE.network, decoder=None, text=replace(RECIPE.network.text, sentence_head=16))
    recipe = replace(RECIPE, network=network, steps=2, head_steps=3)
    once, twice = (Trainer(tmp_path / "run", recipe, batches).run(say=str).state_dict() for _ in range(2))
    assert all(torch.equal(once[name], twice[name]) for name in once)


def test_a_run_does_not_go_on_with_another_network(prepared, tmp_path: Path) -> None:
    batches, _, _ = prepared
    Trainer(tmp_path, replace(RECIPE, steps=1), batches).run(say=str)
    with pytest.raises(MotionSeekError, match="another network"):
        Trainer(tmp_path, replace(RECIPE, network=replace(RECIPE.network, latent=10)), batches)


def test_clips_that_lie_near_each_other_come_together(prepared) -> None:
    """Twelve of the same kind where alike ones are drawn; by chance they would be a handful."""
    batches, _, _ = prepared
    texts = {text: i for i, text in enumerate(batches.all_texts)}
    batches = Batches(store(40, 0), None, UNRELATED, batches.tokens, texts, batches.normaliser, RECIPE)
    kinds = np.arange(40 * KINDS) % KINDS
    drawn = [np.bincount(kinds[batches.draw(np.random.default_rng(i)).picked]).max() for i in range(20)]
    batches.embeddings = np.eye(KINDS, dtype=np.float32)[kinds]
    together = [np.bincount(kinds[batches.draw(np.random.default_rng(i)).picked]).max() for i in range(20)]
    assert max(drawn) < min(together)
    assert len(batches.draw(np.random.default_rng(0)).picked) == 16


def test_a_recipe_survives_json() -> None:
    assert Recipe.from_dict(RECIPE.to_dict()) == RECIPE


@pytest.mark.parametrize("wrong", [{"contrast": "infonec"}, {"filter": "fact"}])
def test_a_recipe_knows_its_choices(wrong: dict[str, str]) -> None:
    with pytest.raises(ValueError, match="must be one of"):
        replace(RECIPE, **wrong)


def test_false_negatives_are_masked_and_negatives_are_not(prepared) -> None:
    batches: Batches = prepared[0]
    recipe = RECIPE
    batch = batches.draw(np.random.default_rng(0))
    ignore = batch.ignore.numpy()
    assert ignore.shape == (recipe.batch + len(batch.owners) + recipe.unrelated, recipe.batch)
    assert not ignore[-recipe.unrelated :].any(), "what is about other things is wrong for every motion"
    hard = ignore[recipe.batch : recipe.batch + len(batch.owners)]
    assert [np.flatnonzero(~row).tolist() for row in hard] == [[i] for i in batch.owners.tolist()]
    says_little = [i for i, row in enumerate(ignore[: recipe.batch]) if row.all()]
    assert says_little, "'moves' is true of every motion"
    assert not ignore[: recipe.batch].all()


def test_no_gradient_flows_through_a_pair_that_is_left_out() -> None:
    torch.manual_seed(0)
    text, motion = torch.randn(3, 5, requires_grad=True), torch.randn(3, 5, requires_grad=True)
    ignore = torch.zeros(3, 3, dtype=torch.bool)
    ignore[0, 1:] = ignore[1:, 0] = True
    contrastive(text, motion, 0.1, ignore).backward()
    assert text.grad[0].abs().max() < 1e-6
    assert motion.grad[0].abs().max() < 1e-6
    assert text.grad[1].abs().max() > 1e-3


def test_a_sentence_with_one_thing_changed_is_pushed_away_from_its_motion() -> None:
    motion = torch.eye(2)
    own, far = torch.tensor([[1.0, 0.0], [0.0, 1.0]]), torch.tensor([[0.0, 1.0]])
    told = hard_negative_loss(torch.cat((own, far)), motion, torch.tensor([0]), torch.tensor(0.1))
    mistaken = hard_negative_loss(torch.cat((own.flip(0), own[:1])), motion, torch.tensor([0]), torch.tensor(0.1))
    assert told < 0.01 < mistaken


def test_the_rate_warms_up_and_falls_to_a_twentieth() -> None:
    rates = [learning_rate(step, RECIPE) for step in range(RECIPE.steps + 1)]
    assert rates[: RECIPE.warmup] == sorted(rates[: RECIPE.warmup])
    assert max(rates) == pytest.approx(RECIPE.rate)
    assert rates[-1] == pytest.approx(RECIPE.rate / 20)


def test_real_clips_come_into_every_batch_and_their_like_sentences_are_no_negatives(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    real = PairStore(
        Pair(rng.normal(size=(10, FEATURES)), (text,))
        for text in (
            "kicks with the left leg very hard",
            "kicks with the right leg very hard",
            "kicks the leg very hard",
        )
    )
    recipe = replace(RECIPE, batch=30, real_share=1.0, hard_negatives=0, unrelated=0, similarity=0.6)
    batches, _, _ = prepare(recipe, store(1, 0), real, store(1, 9), None, UNRELATED, Words(), tmp_path)
    ignored = batches.draw(rng).ignore.numpy()
    kinds = sorted({tuple(row) for row in ignored.tolist()}, key=sum)
    assert len(kinds) == 3
    assert not any(all(row) for row in kinds[:2]), "left and right are told apart"
    assert all(kinds[2]), "what names no side may be true of both"
