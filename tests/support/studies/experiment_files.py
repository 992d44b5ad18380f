"""Files of a small study with people."""

from pathlib import Path

EXAMPLE = """\
title: Robots that argue
seed: 5
base: {robots: 2}
within:
  dialogue.condition: [supervisor, collaborator]
between:
  noise.preset: [none, bad wheels]
quota: 4
steps:
  - {step: instructions, text: welcome.md}
  - {step: consent, text: consent.txt}
  - {step: practice, name: practice}
  - {step: check, form: understood.yaml, attempts: 2, repeat: practice}
  - {step: trial, each_condition: true}
  - {step: form, form: workload, each_condition: true}
  - {step: form, form: trust, each_condition: true}
  - {step: form, form: preference, when: {understood.played: 'yes'}}
  - {step: debrief, text: debrief.md}
"""
UNDERSTOOD = """\
title: Before we begin
items:
  - {id: who, text: Who decides where robots go?, scale: choice, options: [you, they], correct: you}
  - {id: played, text: Have you played before?, scale: choice, options: ['yes', 'no']}
"""


def write_experiment(folder: Path, text: str = EXAMPLE) -> Path:
    for name in ("welcome.md", "consent.txt", "debrief.md"):
        (folder / name).write_text("Read this.\n")
    (folder / "understood.yaml").write_text(UNDERSTOOD)
    (folder / "experiment.yaml").write_text(text)
    return folder / "experiment.yaml"


WITH_GAMES = """\
title: x
base: {map: arena8, game.energy: 30, dialogue: {condition: collaborator, adviser_error_rate: 0.5}}
within: {robots: [1, 2]}
quota: 1
steps:
  - {step: trial, each_condition: true, max_seconds: 60}
  - {step: form, form: trust, each_condition: true}
"""
