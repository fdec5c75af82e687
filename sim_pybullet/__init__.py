"""Rover, terrain, head and cameras in PyBullet, behind the ports that hardware would answer."""
