"""Uploads: received and kept in memory, and read in a worker process with limited resources."""
