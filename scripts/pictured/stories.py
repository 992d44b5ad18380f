"""All states of all windows."""

from pictured import arena, desk, participant, researcher, study

STORIES = (*participant.STORIES, *researcher.STORIES, *study.STORIES, *desk.STORIES, *arena.STORIES)
