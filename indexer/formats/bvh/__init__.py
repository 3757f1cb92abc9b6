"""Biovision Hierarchy: `bvh_hierarchy` reads the tree, `bvh_frames` the numbers, `bvh_reader` makes the take."""
