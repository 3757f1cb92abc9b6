"""A model at work: its files, its manifest, batches and windows; the model that ships lies in `default`."""
