"""Getting along a route: guidance from pose and segment to belt travels, and what watches the belts."""
