"""The same bytes from this machine, from MPI ranks and from a Dask cluster."""

import pytest
from ensemble_programs import MPI, PYTHON, STUDY, end, has, none_stays, tables


@pytest.fixture(scope="module")
def local(tmp_path_factory):
    folder = tmp_path_factory.mktemp("local") / "out"
    end(PYTHON, STUDY, folder, "local")
    return tables(folder)


@pytest.mark.parametrize("kind, package, command", (("mpi", "mpi4py", MPI), ("dask", "distributed", [PYTHON])))
def test_the_same_bytes(kind, package, command, local, tmp_path):
    if not has(package):
        pytest.skip(f"there is no {package}")
    folder = tmp_path.resolve() / "out"
    end(*command, STUDY, folder, kind)
    assert tables(folder) == local
    assert len(list(folder.iterdir())) == 2 + 3, list(folder.iterdir())  # results and tables; no logs, and nothing of the run itself
    none_stays(folder)
