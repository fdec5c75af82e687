"""Frames, cameras and poses: projection, kinematics, pose from centres. No pixels."""
