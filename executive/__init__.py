"""The autonomy core: trees, in-situ classification, the pool, the runner. Imports no sibling package."""

from executive.core.arithmetic import settle

settle()
