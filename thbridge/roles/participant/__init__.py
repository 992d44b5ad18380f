"""Programs of the participant: TabUI, and simulated participants that may use TabUI."""
