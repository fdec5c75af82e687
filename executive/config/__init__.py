"""From YAML files to validated, frozen configuration; whatever is wrong is told with its place."""
