"""What other installed distributions add to the project, named by their entry points."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from encoders.errors import BundleError

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint, EntryPoints

#: Groups of entry points: kinds of features, and models.
FEATURES, MODELS = "motionseek.features", "motionseek.models"


def owners(group: str) -> list[tuple[str, str]]:
    """The names in a group, sorted, each with the distribution that adds it; nothing is imported."""
    return sorted({(entry.name, _owner(entry)) for entry in _entry_points(group)})


def load_extension(group: str, name: str) -> Any:
    """The object that an entry point names; None where there is no such entry point.

    Raises
    ------
    BundleError
        If it cannot be imported, or two distributions claim the name.
    """
    found = list(dict.fromkeys(_entry_points(group).select(name=name)))
    if not found:
        return None
    claimants = sorted({_owner(entry) for entry in found})
    if len({entry.value for entry in found}) > 1:
        raise BundleError(f"{group} {name!r} is claimed by {' and '.join(claimants)}; uninstall one of them")
    try:
        return found[0].load()
    except Exception as error:  # whatever the other distribution raises as it is imported
        raise BundleError(f"{group} {name!r} of {claimants[0]} cannot be loaded ({error!r})") from error


def _entry_points(group: str) -> EntryPoints:
    from importlib.metadata import entry_points  # slow to import, and it looks at every distribution

    return entry_points(group=group)


def _owner(entry: EntryPoint) -> str:
    """The distribution of an entry point, with its version."""
    return "an unnamed distribution" if entry.dist is None else f"{entry.dist.name} {entry.dist.version}"
