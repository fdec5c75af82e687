"""The types of node, a file each: control nodes and decorators, and leaves. All of them are registered."""
