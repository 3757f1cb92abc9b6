"""Any skeleton becomes the 22 joints: joint names, topology, landmarks, orientation, rest pose, retargeting."""
