"""Files become a library."""
