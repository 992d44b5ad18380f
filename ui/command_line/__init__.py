"""Parts that commands share: options, settings, output, progress, outcome."""
