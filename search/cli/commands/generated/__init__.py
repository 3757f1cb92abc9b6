"""Commands about generated motion: judging it, making it, and training what makes it."""
