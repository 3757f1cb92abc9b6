"""The commands, one file each; a command imports what is heavy when it runs."""
