"""Programs of the participant: TabUI, and the simulated participants that may use it."""
