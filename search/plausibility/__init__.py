"""What looks wrong in a motion: jumps from frame to frame, feet that slide, a floor that is gone through."""
