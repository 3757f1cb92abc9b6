"""Ball games, swings, fighting, weights and boards."""
