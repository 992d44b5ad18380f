"""YAML as people write it: read into dataclasses with every fault at its line, and edited without touching the rest."""
