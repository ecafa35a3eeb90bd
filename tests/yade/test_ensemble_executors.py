"""The same bytes from this machine, from MPI ranks and from a Dask cluster."""

import tempfile
from pathlib import Path

from ensemble_programs import MPI, PYTHON, STUDY, end, has, none_stays, tables, without

with tempfile.TemporaryDirectory() as root:
    root = Path(root).resolve()
    end(PYTHON, STUDY, root / "local", "local")
    expected = tables(root / "local")
    kinds = {"mpi": MPI if has("mpi4py") else None, "dask": [PYTHON] if has("distributed") else None}
    for kind, command in kinds.items():
        if command is None:
            without(f"there is no package for {kind}")
            continue
        folder = root / kind
        end(*command, STUDY, folder, kind)
        assert tables(folder) == expected, kind
        assert len(list(folder.iterdir())) == 2 + 3, list(folder.iterdir())  # results and tables; no logs, and nothing of the run itself
        none_stays(folder)
print("ensemble: executors")
