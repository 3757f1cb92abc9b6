"""Variants of styles, as manner fields: performers show the same style differently."""

from __future__ import annotations

#: Style -> variants, one of which a performer chooses or mixes in.
STYLE_VARIANTS: dict[str, tuple[dict[str, float], ...]] = {
    "tired": (
        {"pace": -0.55, "stride": -0.45, "swing": -1.0, "bend": 0.75, "nod": 0.4, "tilt": 0.12, "crouch": 0.07,
         "lift": -0.06, "ahead": 0.12, "wander": 0.06, "sway": 0.5, "rock": 0.06, "reach": -0.5, "width": 0.3},
        {"pace": -0.4, "stride": -0.2, "swing": 0.3, "bend": 0.4, "nod": 0.5, "rock": 0.12, "sway": 0.6,
         "crouch": 0.04, "wander": 0.08, "lift": -0.05, "reach": -0.3},
    ),
    "old": (
        {"pace": -0.6, "stride": -0.7, "swing": -1.2, "bend": 0.75, "nod": -0.35, "tilt": 0.12, "crouch": 0.1,
         "lift": -0.06, "width": 0.4, "splay": 0.25, "reach": -0.4, "tremble": 0.005},
        {"pace": -0.35, "stride": -0.4, "swing": -0.3, "bend": 0.3, "rock": 0.08, "limp": 0.3, "crouch": 0.05,
         "lift": -0.04, "toes": 0.25, "nod": 0.15, "reach": -0.3},
    ),
    "angry": (
        {"pace": 0.35, "stride": 0.25, "swing": 0.7, "bend": 0.3, "nod": 0.25, "lift": 0.05, "bounce": 0.6,
         "rock": 0.07, "apart": 0.15, "elbow": 0.6, "shrug": 0.2, "jerk": 0.4, "reach": 0.3, "twist": 0.4},
        {"pace": 0.2, "stride": 0.1, "swing": -0.7, "bend": 0.1, "nod": 0.3, "shrug": 0.2, "apart": 0.1,
         "lift": 0.06, "jerk": 0.5, "width": 0.3, "twist": -0.4},
    ),
    "happy": (
        {"pace": 0.15, "stride": 0.1, "swing": 0.9, "bend": -0.15, "nod": -0.2, "bounce": 1.3, "pulse": 0.035,
         "lift": 0.12, "apart": 0.2, "raised": 0.1, "rock": 0.06, "twist": 0.4, "reach": 0.3},
        {"pace": 0.05, "swing": 0.3, "bounce": 0.5, "sway": 0.7, "raised": 0.3, "apart": 0.15, "rock": 0.1,
         "nod": -0.1, "lift": 0.05, "reach": 0.25, "pulse": 0.015},
    ),
    "proud": (
        {"pace": -0.2, "stride": 0.2, "swing": 0.5, "bend": -0.4, "nod": -0.3, "apart": 0.2, "lift": 0.08,
         "elbow": 0.5, "shrug": -0.08, "twist": 0.4, "rock": 0.05, "reach": 0.15},
        {"pace": -0.2, "swing": -0.6, "bend": -0.25, "tilt": -0.1, "nod": -0.15, "width": 0.2, "toes": 0.3},
    ),
    "sad": (
        {"pace": -0.55, "stride": -0.5, "swing": -1.4, "bend": 0.5, "nod": 0.8, "lift": -0.06, "crouch": 0.03,
         "bounce": -0.6, "ahead": 0.1, "reach": -0.6, "sway": 0.2, "shrug": -0.1},
        {"pace": -0.25, "stride": -0.2, "swing": -0.3, "bend": 0.15, "nod": 0.75, "rock": 0.05, "sway": 0.3,
         "lift": -0.04, "reach": -0.3},
    ),
    "heavy": (
        {"pace": -0.6, "stride": 0.2, "swing": 0.2, "width": 1.1, "sway": 1.0, "apart": 0.4, "elbow": 0.5,
         "rock": 0.16, "lift": 0.14, "crouch": 0.05, "bounce": 0.8, "bend": 0.12, "splay": 0.35, "toes": 0.35},
        {"pace": -0.45, "stride": 0.1, "swing": 0.4, "width": 0.9, "apart": 0.25, "ahead": 0.15, "raised": 0.15,
         "bend": 0.35, "nod": -0.1, "rock": 0.12, "lift": 0.1, "shrug": 0.15, "splay": 0.3, "crouch": 0.08},
    ),
    "feminine": (
        {"pace": -0.05, "sway": 1.2, "width": -1.2, "swing": 0.4, "apart": 0.15, "elbow": -0.5, "raised": 0.12,
         "bend": -0.12, "twist": 0.7, "rock": 0.03, "splay": -0.15, "nod": -0.08},
        {"pace": 0.05, "stride": -0.3, "sway": 0.7, "width": -0.8, "swing": -0.5, "apart": -0.04, "raised": 0.25,
         "elbow": -0.4, "splay": -0.25, "toes": -0.2, "bounce": 0.3, "lift": 0.03},
    ),
    "masculine": (
        {"pace": -0.15, "stride": 0.25, "swing": 0.5, "width": 0.9, "apart": 0.32, "elbow": 0.6, "shrug": 0.12,
         "rock": 0.1, "splay": 0.35, "toes": 0.35, "twist": 0.5, "bend": -0.08},
        {"pace": 0.02, "stride": 0.15, "swing": 0.2, "width": 0.5, "apart": 0.2, "raised": 0.1, "elbow": 0.5,
         "bend": 0.08, "nod": 0.05, "rock": 0.05, "splay": 0.2},
    ),
    "childlike": (
        {"pace": 0.3, "stride": 0.05, "swing": 1.2, "bounce": 1.5, "pulse": 0.03, "lift": 0.18, "apart": 0.3,
         "raised": 0.15, "rock": 0.12, "twist": 0.6, "reach": 0.4, "wander": 0.05},
        {"pace": 0.2, "stride": -0.4, "swing": -0.3, "bounce": 0.5, "lift": 0.06, "apart": 0.4, "rock": 0.15,
         "width": 0.5, "wander": 0.06, "toes": -0.15, "bend": -0.08},
    ),
    "energetic": (
        {"pace": 0.45, "stride": 0.25, "swing": 0.9, "bounce": 0.9, "lift": 0.12, "raised": 0.2, "apart": 0.1,
         "twist": 0.5, "bend": -0.05, "reach": 0.35, "pulse": 0.015},
        {"pace": 0.25, "stride": 0.2, "swing": 0.7, "bend": 0.15, "lift": 0.06, "twist": 0.4, "elbow": 0.3,
         "raised": 0.25, "bounce": 0.5, "reach": 0.2},
    ),
    "shy": (
        {"pace": -0.35, "stride": -0.6, "swing": -1.5, "bend": 0.4, "nod": 0.5, "apart": -0.08, "raised": 0.3,
         "ahead": 0.15, "width": -0.6, "shrug": 0.3, "splay": -0.25, "toes": -0.25, "reach": -0.6, "lift": -0.03},
        {"pace": -0.15, "stride": -0.25, "swing": -1.0, "bend": 0.1, "nod": 0.3, "jerk": 0.3, "wander": 0.05,
         "apart": -0.06, "twist": -0.5, "reach": -0.4, "crouch": 0.03},
    ),
    "tough": (
        {"pace": -0.2, "stride": 0.15, "swing": -0.2, "bend": 0.4, "nod": -0.35, "apart": 0.1, "elbow": 0.6,
         "width": 1.0, "splay": 0.5, "toes": 0.5, "rock": 0.22, "twist": 0.3, "crouch": 0.06, "sway": 0.6},
        {"pace": 0.0, "stride": 0.2, "swing": 0.9, "bend": -0.15, "nod": -0.25, "apart": 0.35, "rock": 0.15,
         "width": 0.6, "toes": 0.35, "twist": 1.0, "elbow": 0.6, "lift": 0.04},
    ),
    "musical": (
        {"pace": -0.05, "swing": -0.4, "bounce": 1.2, "pulse": 0.05, "sway": 1.1, "raised": 0.5, "ahead": 0.1,
         "apart": 0.1, "rock": 0.15, "twist": 0.3, "nod": 0.05, "elbow": 0.3},
        {"pace": 0.1, "stride": 0.1, "swing": 0.9, "bounce": 1.0, "pulse": 0.025, "sway": 0.4, "lift": 0.12,
         "apart": 0.25, "twist": 0.9, "rock": 0.05, "bend": -0.1},
    ),
}  # fmt: skip
