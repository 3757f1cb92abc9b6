"""TMR's networks, and what stands before them: normalising and padding."""
