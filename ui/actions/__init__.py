"""What commands read and show beside their options; each module is loaded by its command when that is called."""
