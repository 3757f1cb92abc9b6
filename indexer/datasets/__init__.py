"""Folders of captioned motion to train and validate on."""
