"""WallHistory.about: what was run."""

from masonry._given import shown

# Names that masonry writes into `about`; a script may add more.
_ABOUT = {"script": str, "materials": list, "masses": list, "motions": list, "loads": list, "ties": list, "model": dict, "solver": dict, "notes": list, "versions": dict}


def about_given(about):
    """The dict; ValueError unless it is one, in which the names that masonry writes have values of their kinds."""
    if about is not None and not isinstance(about, dict):
        raise ValueError(f"about = {shown(about)}: must be a dict, or None")
    for name, kind in _ABOUT.items():
        if not isinstance((about or {}).get(name, kind()), kind):
            raise ValueError(f"about[{name!r}] = {shown(about[name])}: must be a {kind.__name__}")
    if not all(isinstance(note, str) and note for note in (about or {}).get("notes", [])):
        raise ValueError(f"about['notes'] = {shown(about['notes'])}: must be texts that are not empty")
    return dict(about or {})


def about_of(about, ids):
    """`about` with the materials, masses, motions and loads of these bodies alone."""
    found = dict(about)
    for name in ("materials", "masses", "motions", "loads"):
        if name in about:
            found[name] = [{**one, "ids": sorted(set(one["ids"]) & set(ids))} for one in about[name] if set(one["ids"]) & set(ids)]
    if "ties" in about:
        inside = [{**one, "ids": [pair for pair in one["ids"] if set(pair) <= set(ids)]} for one in about["ties"]]
        found["ties"] = [one for one in inside if one["ids"]]
    return found
