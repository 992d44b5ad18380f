"""All that participants are told, before, in and after a game; nothing before they agree to take part."""
