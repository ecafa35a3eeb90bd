"""Runs scenes in YADE and appends a JSON line each to a file: hashes and positions at ten times of the run. Run by ./run: BITS_FILE, BITS_NAMES (a
name a line; none: all), BITS_THREADS (2: only what is to run with two threads)."""

import contextlib
import hashlib
import io
import json
import os
import time
import warnings

import numpy as np
from masonry import dem
from scenes import SAVED, SCENES, THREADS
from yade import O, Box

LOOKS = 10


def sha(numbers):
    numbers = np.asarray(numbers, dtype=float)
    return hashlib.sha256(np.where(np.isnan(numbers), np.nan, numbers).tobytes()).hexdigest()[:16]  # the sign of NaN means nothing


def look():
    bodies = [b for b in O.bodies if b is not None]
    states = [b.state for b in bodies]
    impacts = dem.impacts()
    return {"time": O.time, "state": sha([x for s in states for x in (*s.pos, *s.ori, *s.vel, *s.angVel)]), "energies": sha(list(dem.energy().values())),
            "impacts": sha(impacts["time"]), "count": len(impacts), "positions": [list(s.pos) for s in states]}


def row(name, way):
    seconds, build, options, _ = SCENES[name]
    row, begin = {"scene": f"{name}; {way}" if way else name, "looks": []}, time.process_time()
    try:
        given = build() or {}
        then = given.pop("then", None)
        O.engines = dem.engines(**given, **options)
        if then:
            then()
        if way == THREADS:
            for engine in O.engines:
                engine.ompThreads = 2
        row["sizes"] = [2 * min(b.shape.extents) if isinstance(b.shape, Box) else 2 * b.shape.radius for b in O.bodies]
        for k in range(LOOKS):
            if way == SAVED and k in (3, 7):
                O.saveTmp()
                O.loadTmp()
            dem.run(seconds * (k + 1) / LOOKS - O.time, progress=False)
            row["looks"].append(look())
    except (RuntimeError, ValueError) as refused:
        row["error"] = f"{refused}"[:300]
    return {**row, "cpu": round(time.process_time() - begin, 2)}


threads = int(os.environ["BITS_THREADS"])
for name in os.environ["BITS_NAMES"].splitlines() or SCENES:
    for way in (["", SAVED] if threads == 1 else [THREADS]):
        if way and way not in SCENES[name][3]:
            continue
        with contextlib.redirect_stdout(io.StringIO()), warnings.catch_warnings():
            warnings.simplefilter("ignore")
            made = row(name, way)
        with open(os.environ["BITS_FILE"], "a") as file:
            file.write(json.dumps(made) + "\n")
