"""Every class of the plugin is a full citizen of YADE: found by name, made by keywords, copied, pickled."""

import copy
import importlib
import pickle
import sys

import numpy as np
import pytest
import yade
from masonry import dem
from rocking_scene import refuses
from yade import O

import masonry._yade

NAMES = masonry._yade.setup()


def test_names():
    assert "BlockMat" in NAMES and NAMES == sorted(NAMES)


def same(a, b):
    """Attribute by attribute, by what Python prints: objects count by class, NaN equals NaN."""

    def shown(value):
        return type(value).__name__ if hasattr(value, "dict") else repr(value)

    a, b = a.dict(), b.dict()
    return a.keys() == b.keys() and all(
        [shown(x) for x in a[key]] == [shown(x) for x in b[key]] if isinstance(a[key], list) else shown(a[key]) == shown(b[key])
        for key in a
    )


@pytest.mark.parametrize("name", NAMES)
def test_a_class(name):
    cls = getattr(dem, name)
    assert getattr(yade, name) is cls and name in yade.__all__
    assert cls.__doc__, f"{name} has no documentation"
    base = cls.__mro__[1].__name__
    assert name in yade.system.childClasses(base)

    plain = cls()
    assert type(plain) is cls
    assert same(plain, cls(**plain.dict())), f"{name}: keywords"
    assert same(plain, pickle.loads(pickle.dumps(plain))), f"{name}: pickle"
    assert same(plain, copy.copy(plain)), f"{name}: copy"
    assert same(plain, copy.deepcopy(plain)), f"{name}: deep copy"
    # YADE's object editor reads type and flags there.
    for attribute in plain.dict().keys() - cls.__mro__[1]().dict().keys():
        doc = getattr(cls, attribute).__doc__
        assert ":yattrtype:`" in doc and ":yattrflags:`" in doc, attribute

    with pytest.raises(AttributeError, match="noSuchAttribute"):
        cls(noSuchAttribute=1)


def test_numbers_out_of_arrays():
    """Numbers out of arrays are numbers; what does not fit, or is none, still has its error."""
    train = dem.PulseTrainEngine(ids=np.array([3, 4]), impulse=np.float32(0.5), resonantBlock=np.int64(7), times=np.array([0, 1]))
    assert (train.ids, train.impulse, train.resonantBlock, train.times) == ([3, 4], 0.5, 7, [0, 1])
    for value, error in ((np.int64(2**40), OverflowError), (np.float64(1.5), TypeError), (np.array([1, 2]), TypeError), ("1", TypeError)):
        with pytest.raises(error):
            train.resonantBlock = value
        assert train.resonantBlock == 7


def test_loading_again_changes_nothing():
    """Loading again changes nothing: neither the classes nor what is made of them."""
    before = dem.BlockMat
    importlib.reload(dem)
    assert dem.BlockMat is before and masonry._yade.setup() == NAMES
    O.materials.append(dem.BlockMat(label="stone"))
    assert O.materials["stone"].dispHierarchy() == ["BlockMat", "FrictMat", "ElastMat", "Material"]


def test_without_a_build(monkeypatch):
    """The import says what to do."""
    monkeypatch.setitem(sys.modules, "masonry._yade", None)
    refuses(dem._load.load_classes, "build it with `cmake -B build", "PYTHONPATH", kind=ImportError)
