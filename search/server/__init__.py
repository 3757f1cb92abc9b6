"""The HTTP server of one library. Needs the extra `serve`."""
