"""The nouns everything else is said in: values, ports, clock, errors, chance, units, the registry."""
