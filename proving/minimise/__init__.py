"""The minimiser: a failing case made as small as it can be and still fail in the same way."""
