"""The pictures of the pages: which script makes each, and their making. Run by scripts/gallery.

    python3 docs/pictures.py [--validation] [--output FOLDER] [NAME ...]

runs the scripts of docs/gallery, or those that are named, in FOLDER (docs/gallery), and ends with status 1 when one fails or a picture is missing or blank.
PYTHONPATH names the built package.
"""
import argparse
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
from PIL import Image

ROOT = Path(__file__).resolve().parents[1]
GALLERY = ROOT / "docs/gallery"
# {script of docs/gallery: (interpreter, pictures)}
SCRIPTS = {
    "arch": ("yade", ("thrust.png", "arch.png", "arch.gif")),
    "building": ("yade", ("building.png",)),
    "chapel": ("yade", ("chapel.png",)),
    "collapse": ("yade", ("collapse.gif", "joints.png", "energy.png", "report.png")),
    "convex_blocks": ("yade", ("convex_blocks.png",)),
    "cracks": ("yade", ("cracks.png",)),
    "gable": ("yade", ("gable.png",)),
    "fragility": ("python", ("fragility.png",)),
    "impact_law": ("python", ("impact_law.png",)),
    "mortar_wall": ("yade", ("mortar_wall.png",)),
    "overturning": ("python", ("overturning.png",)),
    "push": ("yade", ("push_shape.png", "push_joint.png", "push_cycles.png")),
    "resonance": ("python", ("resonance.png",)),
    "spectra": ("python", ("rocking_spectrum.png", "response_spectrum.png")),
}
# {picture under version control: (command, the file that it writes)}
VALIDATION = {
    "validation/paper/figures/figure_6_spectrum_C0.7.png": ("validation/paper/run", "results/paper/figure_6_spectrum_C0.7.png"),
    "validation/mortar/shear_wall.png": ("validation/mortar/run --shear-wall", "results/mortar/shear_wall.png"),
    "validation/convex/frusta.png": ("validation/convex/run", "results/convex/frusta.png"),
    "validation/convex/decay.png": ("validation/convex/run", "results/convex/decay.png"),
    "validation/walls/tilting/wall_6.png": ("validation/walls/tilting/run", "results/tilting/wall_6.png"),
    "validation/walls/tilting/wall_10.png": ("validation/walls/tilting/run", "results/tilting/wall_10.png"),
    "validation/walls/restitution/overturning.png": ("validation/walls/restitution/run", "results/restitution/overturning.png"),
    "validation/walls/ensemble/drift.png": ("validation/walls/ensemble/run", "results/pier_ensemble/drift.png"),
    "validation/walls/shaking/figure.png": ("validation/walls/shaking/run", "results/shaken_walls.png"),
    "validation/speed_against_error/figure.png": ("validation/speed_against_error/run", "results/speed_against_error.png"),
    "validation/stability/stability.png": ("validation/stability/run", "results/stability/stability.png"),
}
# What is not there on every machine: {picture: program}
OPTIONAL = {"report.png": "chromium"}
_INTERPRETERS = {"yade": ["yade", "-j1", "-n", "-x"], "python": ["/usr/bin/python3"]}
_SMALLEST = 200  # pixels
_BLANK = 10  # standard deviation of the grey, of 255: a picture of one colour has none, the palest of the pages has 33


def look(path):
    """(width, height, standard deviation of the grey) of a picture; of the last frame of a film."""
    with Image.open(path) as image:
        image.seek(getattr(image, "n_frames", 1) - 1)
        grey = np.asarray(image.convert("L"), dtype=float)
    return grey.shape[1], grey.shape[0], grey.std()


def _checked(path, since):
    """Says what the picture is; ValueError where it is old, too small or blank."""
    if not path.is_file() or path.stat().st_mtime < since:
        raise ValueError(f"{path} has not been written")
    width, height, contrast = look(path)
    if min(width, height) < _SMALLEST or contrast < _BLANK:
        raise ValueError(f"{path} is {width} x {height} pixels with a contrast of {contrast:.1f}: it is blank or too small")
    return f"{os.path.relpath(path, ROOT) if ROOT in path.parents else path} ({width} x {height})"


def _run(command, folder, pictures):
    """Runs a command in a folder, and says which of the pictures it has made there."""
    since = time.time() - 1  # file systems round times
    subprocess.run(command, cwd=folder, check=True, stdin=subprocess.DEVNULL, env={**os.environ, "OMP_WAIT_POLICY": "passive"})
    for path in pictures:
        print(f"    made {_checked(path, since)}", flush=True)


def main():
    parser = argparse.ArgumentParser(prog="scripts/gallery", description="Makes the pictures of the pages and checks that none is missing or blank.")
    parser.add_argument("scripts", nargs="*", metavar="NAME", help=f"scripts of docs/gallery: {', '.join(SCRIPTS)} (default: all, two minutes)")
    parser.add_argument("--output", type=Path, default=GALLERY, metavar="FOLDER", help="where the pictures are written (default: docs/gallery)")
    parser.add_argument("--validation", action="store_true", help="also run the commands of validation and take their pictures; an hour or two")
    given = parser.parse_args()
    unknown = set(given.scripts) - set(SCRIPTS)
    if unknown:
        parser.error(f"{', '.join(sorted(unknown))}: must be among {', '.join(SCRIPTS)}")
    given.output.mkdir(parents=True, exist_ok=True)
    folder, faults = given.output.resolve(), []
    for name in given.scripts or SCRIPTS:
        interpreter, pictures = SCRIPTS[name]
        print(f"docs/gallery/{name}.py", flush=True)
        try:
            _run([*_INTERPRETERS[interpreter], str(GALLERY / f"{name}.py")], folder,
                 [folder / picture for picture in pictures if picture not in OPTIONAL or shutil.which(OPTIONAL[picture])])
        except (ValueError, subprocess.CalledProcessError) as error:
            faults.append(error)
    for command in dict.fromkeys(command for command, _ in VALIDATION.values()) if given.validation else ():
        print(command, flush=True)
        pictures = {ROOT / kept: ROOT / made for kept, (by, made) in VALIDATION.items() if by == command}
        try:
            _run([str(ROOT / command.split()[0]), *command.split()[1:]], ROOT, pictures.values())
            for kept, made in pictures.items():
                shutil.copyfile(made, kept)
        except (ValueError, subprocess.CalledProcessError) as error:
            faults.append(error)
    for fault in faults:
        print(f"scripts/gallery: {fault}", file=sys.stderr)
    sys.exit(bool(faults))


if __name__ == "__main__":
    main()
