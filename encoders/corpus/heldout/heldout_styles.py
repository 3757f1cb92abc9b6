"""Held-out styles: manner fields like those of `encoders.corpus.engine.style.STYLES`, shown by no training clip."""

HELD_OUT_STYLES: dict[str, dict[str, float]] = {
    "wading": {"pace": -0.6, "stride": -0.1, "swing": 0.1, "lift": 0.2, "apart": 0.3, "raised": 0.2, "bend": 0.1,
        "bounce": 0.2, "sway": 0.3},
    "on ice": {"pace": -0.45, "stride": -0.7, "width": 0.4, "apart": 0.4, "raised": 0.25, "elbow": 0.2, "bend": 0.2,
        "crouch": 0.08, "wander": 0.05, "lift": -0.05, "swing": -0.9},
    "bloated": {"pace": -0.3, "bend": -0.25, "tilt": -0.2, "width": 0.5, "toes": 0.4, "apart": 0.15, "ahead": 0.1,
        "sway": 0.8, "nod": 0.25},
    "soldierly": {"pace": 0.1, "stride": 0.2, "swing": 0.7, "bend": -0.22, "nod": -0.25, "lift": 0.12, "sway": -1.0,
        "twist": -0.6, "jerk": 0.6, "apart": -0.06, "toes": 0.1},
    "freezing": {"pace": 0.15, "stride": -0.35, "bend": 0.3, "nod": 0.3, "shrug": 0.4, "apart": -0.1, "raised": 0.45,
        "ahead": 0.3, "elbow": -0.4, "tremble": 0.008, "width": -0.3},
    "weightless": {"pace": -0.55, "stride": 0.35, "bounce": 1.1, "lift": 0.14, "apart": 0.35, "raised": 0.15,
        "sway": 0.4, "bend": -0.12, "reach": 0.25},
    "stiff-necked": {"pace": -0.15, "nod": -0.35, "shrug": 0.25, "twist": -1.0, "sway": -0.6, "bend": -0.05,
        "swing": -0.5},
    "swaggering": {"pace": -0.2, "width": 0.9, "toes": 0.45, "sway": 0.5, "apart": 0.3, "elbow": 0.5, "roll": 0.05,
        "twist": 0.5, "crouch": 0.04, "swing": 0.1},
}  # fmt: skip
