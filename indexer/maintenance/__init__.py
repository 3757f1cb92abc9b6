"""Check a library, mend it, and forget what it need not keep."""
