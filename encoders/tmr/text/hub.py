"""Language models by folder or name: a name is looked for in the cache of the Hugging Face hub, then on the hub.

all-MiniLM-L6-v2 is that of the installed package.
"""

from __future__ import annotations

import re
from pathlib import Path

from encoders.errors import BundleError
from encoders.tmr.text.language_model import DEFAULT, LanguageModel, packaged_folder

#: What is fetched of a model: weights as plain tensors, never as pickles.
_FILES = ("config.json", "model.safetensors", "tokenizer.json", "tokenizer_config.json", "vocab.txt")
_NAME = re.compile(r"[\w.-]+(/[\w.-]+)?")


def language_folder(named: str) -> Path:
    """The folder of a language model, downloaded if need be.

    Parameters
    ----------
    named : str
        A folder, or the model's name on the hub, such as "distilbert-base-uncased".

    Raises
    ------
    BundleError
        If it is neither, or cannot be downloaded.
    """
    if Path(named).is_dir():
        return Path(named)
    if named == DEFAULT:
        return packaged_folder()
    if not _NAME.fullmatch(named) or named.startswith("."):
        raise BundleError(f"{named}: no such folder, and no name of a language model")
    from huggingface_hub import snapshot_download

    try:
        cached = Path(snapshot_download(named, allow_patterns=list(_FILES), local_files_only=True))
        if any((cached / weights).is_file() for weights in ("model.safetensors", "pytorch_model.bin")):
            return cached
    except Exception:  # it is not in the cache
        pass
    try:
        return Path(snapshot_download(named, allow_patterns=list(_FILES)))
    except Exception as error:  # the hub's errors, the network's, the disk's
        raise BundleError(
            f"{named}: no such folder, not in the hub's cache, and the hub cannot be asked "
            f"({str(error).splitlines()[0][:200]}); name a folder with its config.json, model.safetensors and "
            "tokenizer.json (--language-model DIR)"
        ) from error


def load_language(named: str = DEFAULT) -> LanguageModel:
    """The language model of a folder or name, which cuts no sentence off; raises BundleError, see `language_folder`."""
    folder = language_folder(named)
    return LanguageModel.load(folder, name=folder.name if Path(named).is_dir() else named, max_tokens=None)
