"""What a motion and a sentence are, and how both become vectors. Knows no files of users."""
