"""Tables of an export, one module for each family: columns with units, meanings, and functions for their values."""
