"""The vision chain: difference images, marker centres, stereo pose. Functions on arrays."""
