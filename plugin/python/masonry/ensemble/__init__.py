"""One scene under many motions: each case runs in a YADE process of its own, only what is missing is computed, and statistics say what the cases
have in common.

    # shaken.py: the scene
    def run(case):                                  # in YADE; case: a dict of plain values
        ...
        return results.collapse(dem.wall_history(recorder)).numbers()

    # study.py: plain Python
    from masonry import ensemble
    cases = [{"seed": seed, "scale": scale} for scale in (0.2, 0.4) for seed in range(50)]
    table = ensemble.run("shaken.py", cases, "results/study")
    print(ensemble.statistics(table, by="scale"))

The same study.py runs as an array of jobs on a cluster: `masonry ensemble study.py --slice 3/40` in each job, `masonry ensemble study.py --gather` at last.
"""

from masonry._calls import check_keywords as _check_keywords

from .statistics import fraction, quantile, statistics
from .study import result, run
from .table import dataset, load

__all__ = ["dataset", "fraction", "load", "quantile", "result", "run", "statistics"]

_check_keywords(__name__)
