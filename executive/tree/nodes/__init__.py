"""The leaves, a file each or a family of them; they are registered under `longarm.leaves`."""
