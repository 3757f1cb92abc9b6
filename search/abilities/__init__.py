"""What a library can do: each module a base class of `search.library.Library`."""
