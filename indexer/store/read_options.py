"""ReadOptions: what besides a file's content decides the motion it gives.

The frame rate of a file is the first that is known of

1. `fps` in a captions table (`captions.csv`, `.tsv` or `.jsonl`) that names the file,
2. `--fps` of this run, or `fps` of `motionseek.index`,
3. the same of an earlier run in which the file was read,
4. what the file states,
5. `default_fps` of its format in `indexer.formats.table`.

`indexer.ingest.changes.RequestedOptions.for_file` decides 1 to 3, `indexer.formats.reading.read_takes` 4 and 5.
The axis that is up is that of the same, `up` and `--up`, in the same order, else what `indexer.rigs.up_axis` finds.
For a file that is not indexed see `indexer.ingest.unindexed`, in which `fps` of the call comes first.
"""

from __future__ import annotations

import json
from dataclasses import dataclass

#: Grows when a reader changes what it gives, so that all files are read again.
READER_VERSION = 2


@dataclass(frozen=True)
class ReadOptions:
    """How a file was read.

    Attributes
    ----------
    fps : float or None
        The frame rate given for it, None where the file's own was used.
    from_table : bool
        Whether a captions table gave the frame rate.
    joint_map : tuple of (target joint, joint of the file)
        The joint map given for it.
    up : str or None
        The axis given for it as up.
    up_from_table : bool
        Whether a captions table gave that axis.
    version : int
        `READER_VERSION` at that time; -1 where it is not known.
    """

    fps: float | None = None
    from_table: bool = False
    joint_map: tuple[tuple[str, str], ...] = ()
    version: int = READER_VERSION
    up: str | None = None
    up_from_table: bool = False

    def text(self) -> str:
        """The options as they are stored."""
        values = [self.version, self.fps, self.from_table, self.joint_map, self.up, self.up_from_table]
        return json.dumps(values, ensure_ascii=False)

    @staticmethod
    def of(text: str) -> ReadOptions:
        """The options that `text` stored."""
        try:
            version, fps, from_table, joint_map, *later = json.loads(text)
            names = tuple((str(a), str(b)) for a, b in joint_map)
            return ReadOptions(fps, from_table, names, version, *later[:2])
        except (ValueError, TypeError):
            return ReadOptions(version=-1)
