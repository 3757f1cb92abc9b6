"""From motions and sentences to a trained TMR: pairs, batches, losses, the loop."""
