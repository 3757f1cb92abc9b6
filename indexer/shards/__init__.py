"""One archive, many indexers: which files are whose, and what each of them puts into the collection they share."""
