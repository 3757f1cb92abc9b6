"""NumPy files: arrays of joints and features, and parameters of the body models of SMPL."""
