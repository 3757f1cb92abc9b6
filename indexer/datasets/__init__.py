"""Folders of captioned or labelled motion, to train, validate and evaluate on."""
