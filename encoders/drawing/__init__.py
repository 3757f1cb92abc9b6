"""Drawing of motions given as arrays: the capsule model of a body, and the notebook player."""
