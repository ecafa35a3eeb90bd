"""What the command yade-masonry runs: YADE, with the plugin's classes loaded as soon as YADE itself is.

Arguments: the command's own path, then those of yade. Runs as a file, not as part of the package, so that nothing is
imported before yade has read its options (the number of threads is fixed when its libraries are opened).
"""

import builtins
import importlib.machinery
import runpy
import shutil
import sys


class _AfterYade:
    """Finds the package `yade` as usual, and registers the plugin's classes when its import is done."""

    def find_spec(self, name, path=None, target=None):
        if name != "yade":
            return None
        sys.meta_path.remove(self)
        spec = importlib.machinery.PathFinder.find_spec(name, path, target)
        if spec is not None:
            execute = spec.loader.exec_module

            def execute_and_register(module):
                execute(module)
                from masonry.dem._load import load_classes

                # Scripts see the names of yade.utils, which were taken from yade while it was imported.
                vars(module.utils).update(load_classes())

            spec.loader.exec_module = execute_and_register
        return spec


def main():
    sys.argv = sys.argv[1:]
    yade = shutil.which("yade")
    if yade is None:
        sys.exit("yade-masonry needs YADE: install it with `apt install yade`.")
    sys.path[0] = yade.rpartition("/")[0]  # as when yade is started; this file's folder would shadow modules
    sys.meta_path.insert(0, _AfterYade())
    # YADE binds labels of engines as __builtins__.label: in the main module of an interpreter that is the module.
    runpy.run_path(yade, {"__builtins__": builtins}, "__main__")


main()
