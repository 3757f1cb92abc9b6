"""The local server: HTTP around one library. Needs the extra `serve`."""
