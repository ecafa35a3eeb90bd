# Run by yade-masonry: the classes are there without an import, and so are the script's arguments.
import sys

assert BlockMat(restitution=0.5).restitution == 0.5
assert sys.argv[1:] == ["given"], sys.argv
O.engines = [ForceResetter(), NewtonIntegrator(label="newton")]
O.run(10, True)
assert newton.label == "newton"

from masonry import dem

assert dem.BlockMat is BlockMat
