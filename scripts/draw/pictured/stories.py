"""All states of all windows."""

from pictured import arena, desk, kiosk, participant, researcher, study

STORIES = (*participant.STORIES, *researcher.STORIES, *study.STORIES, *kiosk.STORIES, *desk.STORIES, *arena.STORIES)
