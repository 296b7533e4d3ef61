"""The files that all studies write alike: a JSON document and tables."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any


def as_json(document: Mapping[str, Any]) -> str:
    """The machine-readable result."""
    return json.dumps(document, indent=1, ensure_ascii=False, allow_nan=False)


def write_csv(path: Path, columns: Iterable[str], rows: Iterable[Mapping[str, Any]]) -> None:
    """A table; what a row has beyond the columns is left out, a list is written with spaces between its items."""
    with path.open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, list(columns), extrasaction="ignore")
        table.writeheader()
        for row in rows:
            table.writerow({k: " ".join(map(str, v)) if isinstance(v, list) else v for k, v in row.items()})
