"""Seeds of made clips, so that what is trained on never meets what is measured on."""

#: Shards of the training corpus count up from here; the others stay clear of it.
TRAINING = 0
#: Runs with another seed see other clips, so that their mean has seen more.
RUNS_APART = 1000
VALIDATION = 1_000_000
TEST = 2_000_000
CALIBRATION = 3_000_000
