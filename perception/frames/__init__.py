"""From exposures to difference images: shots, codes, stacks, vibration, exposure."""
