"""Recordings read: messages in order, at random by topic and time, and all that is left of damaged ones."""
