"""The `motionseek` command, and the check that no other software hides motionseek's packages.

`encoders`, `indexer` and `search` are common names. What comes first on the import path under one of them would be
imported instead of ours, so this module looks before it imports any.
"""

from __future__ import annotations

import sys

TYPE_CHECKING = False
if TYPE_CHECKING:
    from pathlib import Path

PACKAGES = ("encoders", "indexer", "search")


def hidden_package() -> str | None:
    """One line about the first of our packages that Python would not find, or None where it finds all of them."""
    from pathlib import Path

    home = Path(__file__).resolve().parent
    for name in PACKAGES:
        found = _location(name)
        if found is None:
            return f"the package '{name}' is missing from {home}; install motionseek again"
        if found.resolve() not in (home / name, home / name / "__init__.py"):
            return (
                f"motionseek's package '{name}' is hidden by {found}, which comes first on the import path; "
                "rename or move that, or install motionseek in a virtual environment of its own"
            )
    return None


def _location(name: str) -> Path | None:
    """The file that `import name` runs, or the folder of a package that has no `__init__.py`."""
    from importlib.util import find_spec
    from pathlib import Path

    module = sys.modules.get(name)
    if module is not None and getattr(module, "__spec__", None) is None:
        return Path(getattr(module, "__file__", None) or f"<{name}>")
    spec = find_spec(name)
    if spec is None:
        return None
    if spec.origin is not None:
        return Path(spec.origin)
    return next((Path(folder) for folder in spec.submodule_search_locations or ()), None)


def main() -> None:
    """Run the command line and exit with its code; 1 where one of our packages is hidden."""
    try:
        if hidden := hidden_package():
            sys.exit(f"motionseek: {hidden}")
        from search.cli.main import main as run

        run()
    except KeyboardInterrupt:  # while modules are imported, or a second time while the first is dealt with
        print("motionseek: interrupted", file=sys.stderr)
        sys.exit(130)


if __name__ == "__main__":
    main()
