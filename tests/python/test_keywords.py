"""A keyword that a public call does not have: one sentence names the call, the word and those that are near."""

import inspect
import pickle

import pytest
from masonry import closed_form, ensemble, results, spectra

import masonry

BLOCK = masonry.RockingBlock(0.3, 1.5)


@pytest.mark.parametrize("act, sentence", (
    (lambda: masonry.RockingBlock.from_size(widht=0.4, height=2.0), "masonry.RockingBlock.from_size() has no `widht`; did you mean `width`"),
    (lambda: masonry.Sine(amplitude=1, frequncy=2), "masonry.Sine() has no `frequncy`; did you mean `frequency`"),
    (lambda: masonry.simulate(BLOCK, masonry.PulseTrain(1), restitutoin=0.7), "masonry.simulate() has no `restitutoin`; did you mean `restitution`"),
    (lambda: masonry.artificial_record(seed=1, peek=1), "masonry.artificial_record() has no `peek`; did you mean `peak`"),
    (lambda: masonry.PulseTrain(1).scaled(factr=2), "masonry.PulseTrain.scaled() has no `factr`; did you mean `factor`"),
    (lambda: masonry.RockingBlock(0.3, 1.5, xyzzy=2), "masonry.RockingBlock() has no `xyzzy`; it takes `"),
    (lambda: closed_form.single_pulse(blok=BLOCK, impulse=1), "closed_form.single_pulse() has no `blok`; did you mean `block`"),
    (lambda: spectra.response(masonry.Sine(1, 1), dampng=0.05), "spectra.response() has no `dampng`; did you mean `damping`"),
    (lambda: spectra.rocking(masonry.Sine, 0.4, slendernes=4, amplitude=1, frequency=2), "spectra.rocking() has no `slendernes`; did you mean `slenderness`?"),
    (lambda: results.draw(None, "wall.png", tme=1), "results.draw() has no `tme`; did you mean `time`"),
    (lambda: results.WallHistory.load(pth="wall.npz"), "results.WallHistory.load() has no `pth`; did you mean `path`"),
    (lambda: ensemble.statistics([], bye="scale"), "ensemble.statistics() has no `bye`; did you mean `by`"),
))
def test_misspelled_keywords(act, sentence):
    with pytest.raises(TypeError) as error:
        act()
    assert str(error.value).startswith(sentence) and "\n" not in str(error.value)


def test_words_that_go_on_to_another_call():
    with pytest.raises(ValueError, match="motion = Sine: it has no `frequncy`; did you mean `frequency`?"):
        spectra.rocking(masonry.Sine, 0.4, 4, amplitude=1, frequncy=2)


def test_calls_stay_what_they_are():
    """help() and Sphinx see signature, docstring and name; pickle finds the function."""
    for call in (masonry.simulate, results.draw, spectra.rocking, ensemble.run):
        assert call.__doc__ and "keywords" not in inspect.signature(call).parameters
        assert pickle.loads(pickle.dumps(call)) is call
    assert list(inspect.signature(masonry.RockingBlock.from_size).parameters) == ["width", "height", "gravity"]


@pytest.mark.parametrize("module", (masonry, closed_form, ensemble, results, spectra), ids=lambda module: module.__name__)
def test_every_public_call_checks(module):
    """All of them, but for those whose keywords go on to another call."""
    for name in getattr(module, "__all__", dir(module)):
        thing = getattr(module, name)
        if inspect.isfunction(thing) and name[0] != "_" and thing.__module__.startswith("masonry"):
            kinds = {one.kind for one in inspect.signature(thing).parameters.values()}
            if inspect.Parameter.VAR_KEYWORD not in kinds:
                with pytest.raises(TypeError, match=f"{name}\\(\\) has no `no_such_word`"):
                    thing(no_such_word=1)
