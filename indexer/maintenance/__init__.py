"""Check a library, mend it, forget what it need not keep, and watch its folders."""
