"""Stacks: clips that show one performance, in several rigs or mirrored."""
