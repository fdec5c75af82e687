"""From difference images to marker centres and the pose they carry, near and far."""
