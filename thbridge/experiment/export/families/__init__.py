"""Tables of an export, a module a family: columns with units, meanings, and the functions of their values."""
