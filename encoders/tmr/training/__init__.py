"""Training of TMR: pairs, batches, losses, the loop and its checkpoints."""
