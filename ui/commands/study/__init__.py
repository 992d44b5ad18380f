"""Commands of `thbridge study`."""
