"""The neutral file of a structure's modes."""

import json
import os
from functools import partial
from pathlib import Path

import numpy as np

from fem.modal_files import document, write
from fem.modal_model import ModalModel
from workflows.errors import BadInput
from workflows.io.folder import put, writable


def named(file: str | os.PathLike[str], key: str = "file") -> Path:
    """The path of a neutral file.

    Raises:
        BadInput: its name does not end in .npz or .json, or it is a folder.
    """
    path = Path(file)
    if path.suffix.lower() not in (".npz", ".json"):
        raise BadInput("expected a name that ends in .npz or .json", key=key, value=str(file))
    if not path.absolute().parent.is_dir():
        raise BadInput("expected a file in a folder that is there", key=key, value=str(file))
    return writable(path, key)


def save_modes(model: ModalModel, file: str | os.PathLike[str], key: str = "file") -> Path:
    """Write the neutral file, whole or not at all; what was there is replaced.

    Raises:
        BadInput: it cannot be written.
    """
    return put(named(file, key), partial(write, model), key)


def dumps(model: ModalModel) -> str:
    """The neutral file as JSON."""
    plain = {name: each.tolist() if isinstance(each, np.ndarray) else each for name, each in document(model).items()}
    return json.dumps(plain, allow_nan=False)
