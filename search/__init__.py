"""Search: queries answered from a library, in Python, on the command line and over HTTP."""
