"""The command line beside its commands: options that they share and what these stand for, output, progress, outcome."""
