"""Page of a report: HTML with the pictures in it."""
