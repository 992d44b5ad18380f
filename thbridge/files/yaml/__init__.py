"""YAML files of people: read into dataclasses with every fault at its line, and edited without changing the rest."""
