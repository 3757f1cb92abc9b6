"""Arguments of the library and of indexing, checked before anything is read or written."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from encoders.arguments import finite_number, is_text, shown, whole_number
from encoders.errors import ArgumentError
from encoders.protocol import Encoder
from encoders.skeleton import JOINTS
from indexer.take import UP_AXES

#: Frame rates that can be given, in frames a second, and numbers of reading processes.
LOWEST_RATE, HIGHEST_RATE = 1, 10_000
MOST_JOBS = 256
#: What indexing needs of an `Encoder`: strings, positive numbers and methods.
_ENCODER_STRINGS = ("name", "fingerprint")
_ENCODER_NUMBERS = {"fps": finite_number, "max_frames": whole_number, "latent_size": whole_number}
_ENCODER_METHODS = ("features", "encode_features", "encode_texts")


def checked_rate(fps: Any, name: str = "fps") -> float | None:
    """A frame rate, or None.

    Raises
    ------
    ArgumentError
        If it is no number from `LOWEST_RATE` to `HIGHEST_RATE`.
    """
    if fps is None:
        return None
    rate = finite_number(fps)
    if rate is None or not LOWEST_RATE <= rate <= HIGHEST_RATE:
        raise ArgumentError(f"{name}={shown(fps)} must be a number of frames a second, {LOWEST_RATE} to {HIGHEST_RATE}")
    return rate


def checked_up(up: Any) -> str | None:
    """An axis that is up, one of `UP_AXES`, or None.

    Raises
    ------
    ArgumentError
        If it is anything else.
    """
    if up is not None and up not in UP_AXES:
        raise ArgumentError(f"up={shown(up)} must be one of {', '.join(UP_AXES)}")
    return None if up is None else str(up)


def checked_jobs(jobs: Any) -> int | None:
    """A number of processes, or None.

    Raises
    ------
    ArgumentError
        If it is no whole number from 1 to `MOST_JOBS`.
    """
    if jobs is None:
        return None
    count = whole_number(jobs)
    if count is None or not 1 <= count <= MOST_JOBS:
        raise ArgumentError(f"jobs={shown(jobs)} must be a whole number of processes, 1 to {MOST_JOBS}")
    return count


def checked_joint_map(names: Any, name: str = "joint_map") -> dict[str, str] | None:
    """A joint map (target joint to joint of the file), or None.

    Raises
    ------
    ArgumentError
        If it is no mapping of target joints to names.
    """
    if names is None:
        return None
    if not isinstance(names, Mapping) or not all(isinstance(joint, str) and joint for joint in names.values()):
        raise ArgumentError(f'{name}: values must be joint names, such as {{"left_wrist": "LeftHand"}}')
    unknown = sorted(str(target) for target in names if target not in JOINTS)
    if unknown:
        raise ArgumentError(
            f"{name}: unknown target joint {', '.join(unknown)}; the target joints are {', '.join(JOINTS)}"
        )
    return dict(names)


def checked_encoder(bundle: Any) -> Encoder | None:
    """A model, or None.

    Raises
    ------
    ArgumentError
        If it lacks what indexing needs of an `encoders.protocol.Encoder`.
    """
    if bundle is None:
        return None
    strings = {name: getattr(bundle, name, None) for name in _ENCODER_STRINGS}
    wrong = [name for name, text in strings.items() if not isinstance(text, str) or not is_text(text) or not text]
    wrong += [name for name, number in _ENCODER_NUMBERS.items() if not (number(getattr(bundle, name, None)) or 0) > 0]
    wrong += [name for name in _ENCODER_METHODS if not callable(getattr(bundle, name, None))]
    if wrong or isinstance(bundle, type):
        raise ArgumentError(
            f"bundle={shown(bundle)} must be an Encoder, such as Bundle.load(); missing or wrong: {', '.join(wrong)}"
        )
    model: Encoder = bundle
    return model


def checked_clip_id(id: Any) -> int:
    """The number of a clip.

    Raises
    ------
    ArgumentError
        If it is no whole number.
    """
    number = whole_number(id)
    if number is None:
        raise ArgumentError(f"id={shown(id)} must be the number of a clip")
    return number
