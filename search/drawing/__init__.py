"""Pictures of motion: strips of poses, animations, and plots of similarity over time."""
