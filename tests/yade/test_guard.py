"""The guard accepts the packaged YADE and refuses any other with one sentence."""

import guard_probe

guard_probe.require([])

for change, found in [
    (("version", "2024.01"), "this is YADE 2023.02a"),
    (("build id", "libyade.so", "0123"), "libyade.so has build id ab5587ac78af12fe3854492b492477acfe3232cf instead of 0123"),
    (("size", "State", 328), "its State takes 320 bytes instead of 328"),
    (("size", "LawFunctor", 96), "its LawFunctor takes 88 bytes instead of 96"),
]:
    try:
        guard_probe.require([change])
    except RuntimeError as error:
        sentence = str(error)
        assert sentence.startswith("masonry does not fit this YADE: " + found), sentence
        assert "yade 2023.02a-1" in sentence and "apt install yade" in sentence, sentence
        assert "\n" not in sentence and sentence.count(". ") == 0, sentence
    else:
        raise AssertionError(f"accepted {change}")
