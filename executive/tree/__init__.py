"""Tree files → validated specifications → py_trees."""
