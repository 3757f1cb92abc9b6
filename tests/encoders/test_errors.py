"""Errors: classes by cause, below one base, that pass between processes."""

import pickle

import pytest

from encoders import errors

ERRORS = [
    errors.UnreadableMotion("a.bvh", "it is empty"),
    errors.UnknownRig("a.bvh", ["left_knee", "head"]),
    errors.UnknownRig("a.bvh", ["head"], "no body"),
    *(
        kind("what is wrong")
        for kind in (
            errors.LibraryNotFound, errors.LibraryLocked, errors.LibraryDamaged, errors.UnknownClip,
            errors.DatasetError, errors.MissingSplit, errors.MissingMotion, errors.WrongFeatureSize,
            errors.NotFinite, errors.WrongFrameRate,
            errors.BundleError, errors.BundleMismatch, errors.QueryError, errors.ArgumentError, errors.MissingProgram,
        )
    ),
]  # fmt: skip


@pytest.mark.parametrize("error", ERRORS, ids=lambda error: type(error).__name__)
def test_errors_survive_pickling_and_share_a_base(error):
    assert isinstance(error, errors.MotionSeekError)
    copy = pickle.loads(pickle.dumps(error))
    assert type(copy) is type(error)
    assert (str(copy), copy.args, vars(copy)) == (str(error), error.args, vars(error))


@pytest.mark.parametrize(
    ("kind", "base"),
    [
        (errors.LibraryNotFound, errors.LibraryError),
        (errors.LibraryLocked, errors.LibraryError),
        (errors.LibraryDamaged, errors.LibraryError),
        (errors.UnknownClip, errors.LibraryError),
        *(
            (kind, errors.DatasetError)
            for kind in (
                errors.MissingSplit,
                errors.MissingMotion,
                errors.WrongFeatureSize,
                errors.NotFinite,
                errors.WrongFrameRate,
            )
        ),
        (errors.ArgumentError, errors.QueryError),
        (errors.UnknownRig, errors.UnreadableMotion),
    ],
)
def test_a_handler_of_the_wider_class_catches_the_narrower(kind, base):
    assert issubclass(kind, base)
