"""Site of static pages for the documentation: `make docs`."""
