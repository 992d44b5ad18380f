"""Files with secrets: keys of people and of links, which are their owner's alone."""
