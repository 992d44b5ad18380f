"""Files with secrets: keys of people and of links, which only their owner may read."""
