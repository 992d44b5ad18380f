"""All states of all windows."""

from pictured import participant, researcher, study

STORIES = (*participant.STORIES, *researcher.STORIES, *study.STORIES)
