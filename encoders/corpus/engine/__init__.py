"""The motion engine: curves, footsteps, key poses, styles, joins, and posing a skeleton by inverse kinematics."""
