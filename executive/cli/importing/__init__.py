"""BehaviorTree.CPP v4 XML → tree files of this project."""

from executive.cli.importing.trees import Imported, import_file
from executive.cli.importing.written import tree_text, write_trees

__all__ = ["Imported", "import_file", "tree_text", "write_trees"]
