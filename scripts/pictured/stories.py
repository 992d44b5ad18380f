"""All states of all windows."""

from pictured import arena, participant, researcher, study

STORIES = (*participant.STORIES, *researcher.STORIES, *study.STORIES, *arena.STORIES)
