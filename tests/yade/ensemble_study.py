"""The study of the tests of executors and slices: python3 ensemble_study.py FOLDER local|mpi|dask [SCENE]."""

import sys
from pathlib import Path

from masonry import ensemble

CASES = [{"scale": scale, "name": f"sine {scale}"} for scale in (0.32, 1.0)]


def study(folder, scene=None, **more):
    return ensemble.run(scene or Path(__file__).with_name("ensemble_scene.py"), CASES, folder, progress=False, units={"scale": "g"},
                        dimensions={"drift": "sample"}, **more)


if __name__ == "__main__":
    folder, kind, *rest = sys.argv[1:]
    if kind == "mpi":
        from mpi4py.futures import MPIPoolExecutor
        with MPIPoolExecutor() as executor:
            study(folder, *rest, executor=executor)
    elif kind == "dask":
        from distributed import Client, LocalCluster
        with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
            study(folder, *rest, executor=client.get_executor())
    else:
        study(folder, *rest, processes=2)
