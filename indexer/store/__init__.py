"""The library on disk: SQLite's tables, the one writer, stored poses, and what readers see."""
