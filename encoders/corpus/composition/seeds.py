"""Seeds of synthetic clips, disjoint for training, validation, test and calibration."""

#: The first shard of the training corpus; further shards count up from here.
TRAINING = 0
#: Distance of the first shards of two training runs, so that an average of runs covers more clips.
RUNS_APART = 1000
VALIDATION = 1_000_000
TEST = 2_000_000
CALIBRATION = 3_000_000
