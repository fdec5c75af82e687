"""The rover without its markers: outlines at rest, and outlines of what moves."""
