"""The reference, made from the declarations: `longarm reference -o docs/reference`."""

from executive.cli.reference.pages import pages, write_pages

__all__ = ["pages", "write_pages"]
