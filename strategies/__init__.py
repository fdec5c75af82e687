"""Recovery strategies, one module and one `Strategy` each, found by entry point."""
