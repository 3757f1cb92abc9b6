"""Distance of generated motions from the motions they should be: average positional and variance error."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from search.plausibility.body_frame import Array, from_origin, local_pose

#: Name -> the positions (T, K, 3) or (T, K, 2) that are compared, of a motion brought to the origin.
PARTS: dict[str, Callable[[Array], Array]] = {
    "root": lambda joints: joints[:, :1],
    "trajectory": lambda joints: joints[:, :1, ::2],
    "local": lambda joints: local_pose(joints, keep_height=True)[:, 1:],
    "global": lambda joints: joints,
}


def position_and_variance_errors(
    generated: Sequence[NDArray[np.floating]], real: Sequence[NDArray[np.floating]]
) -> dict[str, tuple[float, float]]:
    """APE (metres) and AVE (square metres) of the root, its trajectory, joints in the body's frame, and all joints.

    Ghosh et al. (ICCV 2021) as TEMOS (ECCV 2022), has it: the root's position, the same on the floor, joints but
    the root without heading and place (heights kept), and joints of the world. APE: mean distance over all frames of
    all motions, so that long ones weigh more. AVE: distance between the variances over time (over T - 1, an axis each)
    of a joint, averaged over joints, then motions; papers print it in metres. Both motions begin at the origin and face
    +Z there, as they do when they are rebuilt from TEMOS's features. Where one is longer, its end is not compared.

    Parameters
    ----------
    generated, real : sequences of N arrays (T, 22, 3)
        Pairs, at one frame rate, each with at least two frames.

    Returns
    -------
    {part: (APE, AVE)}
    """
    if len(generated) != len(real) or not generated:
        raise ValueError(f"{len(generated)} generated and {len(real)} real motions: both need the same number, not 0")
    distances: dict[str, list[Array]] = {part: [] for part in PARTS}
    variances: dict[str, list[float]] = {part: [] for part in PARTS}
    for pair in zip(generated, real, strict=True):
        frames = min(map(len, pair))
        if frames < 2:
            raise ValueError(f"motions of {' and '.join(str(len(one)) for one in pair)} frames: at least 2 are needed")
        ours, theirs = (from_origin(np.asarray(joints[:frames], np.float64)) for joints in pair)
        for part, positions in PARTS.items():
            a, b = positions(ours), positions(theirs)
            distances[part].append(np.linalg.norm(a - b, axis=-1))
            spread = a.var(axis=0, ddof=1) - b.var(axis=0, ddof=1)
            variances[part].append(float(np.linalg.norm(spread, axis=-1).mean()))
    return {part: (float(np.concatenate(distances[part]).mean()), float(np.mean(variances[part]))) for part in PARTS}
