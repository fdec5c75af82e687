"""Tree mutation: change a tree a little and see whether the suite notices."""
