"""A model ready for use: its files and manifest, batching and windows; `default` holds the shipped one."""
