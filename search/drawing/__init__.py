"""Pictures of motion: strips of poses, films, and similarity over time."""
