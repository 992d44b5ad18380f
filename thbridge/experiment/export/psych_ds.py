"""The description of an export as Psych-DS asks for it: JSON-LD by schema.org beside the tables.

Source: Psych-DS 1.0, https://psych-ds.github.io.
"""

import json
import re
from collections.abc import Iterable, Sequence

from thbridge.experiment.export.tables import ExperimentTable

JsonLd = dict[str, object]


def file_name(title: str, table: str) -> str:
    """Return the name of a table's file: keywords and values, as Psych-DS spells them."""
    return f"study-{_word(title)}_description-{_word(table)}_data.csv"


def dataset_description(title: str, tables: Iterable[ExperimentTable], notes: Sequence[str]) -> str:
    """Return the text of dataset_description.json.

    Args:
        title: of the experiment.
        tables: all that are exported; each of their columns is described.
        notes: sentences on the data, for its description.
    """
    variables: dict[str, JsonLd] = {}
    for table in tables:
        for column in table.columns:
            told: JsonLd = {"@type": "PropertyValue", "name": column.name, "description": column.meaning}
            if column.unit:
                told["unitText"] = column.unit
            variables.setdefault(column.name, told)
    whole: JsonLd = {
        "@context": "https://schema.org",
        "@type": "Dataset",
        "name": title,
        "description": " ".join(notes),
        "schemaVersion": "Psych-DS 1.0.0",
        "variableMeasured": list(variables.values()),
        "keywords": ["human-robot interaction", "treasure hunt"],
    }
    return json.dumps(whole, indent=2, ensure_ascii=False) + "\n"


def _word(text: str) -> str:
    return re.sub(r"[^A-Za-z0-9]", "", text.title() if " " in text else text) or "experiment"
