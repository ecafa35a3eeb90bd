"""Slot by slot, the virtual tables that the compiler makes of our declarations against those in YADE's libraries.

Arguments: the compiler's class dump of layout.cpp (-fdump-lang-class), the folder of YADE's libraries. The libraries'
tables are read from their dynamic relocations: one function's address a slot. Overloads of one name are not told
apart here; a wrong overload would not link, as every function is an exported symbol.
"""

import re
import subprocess
import sys

LIBRARIES = ("libyade.so", "libpkg_common.so", "libpkg_dem.so")
# Declared with bodies of their own, since YADE has no table for it.
NOT_IN_YADE = {"yade::Indexable"}
# Declared `final`, for reading their members only: what the plugin does not call is not declared.
READ_ONLY = {f"yade::{family}Dispatcher" for family in ("Bound", "IGeom", "IPhys", "Law")}


def output(*command, text=None):
    return subprocess.run(command, input=text, capture_output=True, check=True, text=True).stdout


def without_templates(name):
    depth, kept = 0, []
    for character in name.replace("[abi:cxx11]", "").replace("non-virtual thunk to ", ""):
        depth += character == "<"
        if depth == 0:
            kept.append(character)
        depth -= character == ">"
    return "".join(kept)


def demangled(names):
    """Mangled names to class::function, without parameters and template arguments."""
    names = list(names)
    plain = output("c++filt", "-p", text="\n".join(names)).splitlines()
    return dict(zip(names, map(without_templates, plain)))


def declared_tables(dump):
    """Class name -> {byte offset: function} for every table in the dump."""
    text = open(dump, encoding="utf-8").read()
    tables = {}
    for block in re.findall(r"^Vtable for (yade::\w+)\n(.*?)\n\n", text, re.S | re.M):
        name, body = block
        entries = re.findall(r"^(\d+)\s+\(int \(\*\)\(\.\.\.\)\)(.*)$", body, re.M)
        tables[name] = {int(at): entry for at, entry in entries if "::" in entry and not entry.startswith("(&")}
    thunks = {entry: re.search(r"_ZTh.*", entry).group() for table in tables.values() for entry in table.values() if "_ZTh" in entry}
    plain = demangled(thunks.values())
    return {
        name: {at: plain[thunks[entry]] if entry in thunks else without_templates(entry) for at, entry in table.items()}
        for name, table in tables.items()
    }


def library_tables(path, wanted):
    """Class name -> {byte offset: function} for those of the classes that have a table in one library."""
    places = {}
    for line in output("readelf", "-W", "--dyn-syms", path).splitlines():
        found = re.match(r"\s*\d+: ([0-9a-f]+)\s+(\d+) OBJECT .* (?!UND)\d+ _ZTVN4yade(\d+)(\w+)E$", line)
        if found and len(found[4]) == int(found[3]) and "yade::" + found[4] in wanted:
            places["yade::" + found[4]] = (int(found[1], 16), int(found[2]))
    slots = {}
    for line in output("readelf", "-W", "-r", path).splitlines():
        field = line.split()
        if len(field) >= 5 and field[2] == "R_X86_64_64":
            slots[int(field[0], 16)] = field[4].split("@")[0]
    tables = {
        name: {at: slots[start + at] for at in range(0, size, 8) if slots.get(start + at, "_ZTI")[:4] != "_ZTI"}
        for name, (start, size) in places.items()
    }
    plain = demangled(sorted({symbol for table in tables.values() for symbol in table.values()}))
    return {name: {at: plain[symbol] for at, symbol in table.items()} for name, table in tables.items()}


def main(dump, folder):
    declared = {name: table for name, table in declared_tables(dump).items() if name not in NOT_IN_YADE | READ_ONLY}
    yade = {}
    for library in LIBRARIES:
        yade = {**library_tables(f"{folder}/{library}", declared), **yade}
    wrong = []
    for name, table in sorted(declared.items()):
        if name not in yade:
            wrong.append(f"{name}: YADE has no such table")
            continue
        for at in sorted(set(table) | set(yade[name])):
            ours, theirs = table.get(at, "nothing"), yade[name].get(at, "nothing")
            if ours != theirs:
                wrong.append(f"{name} at {at}: declared {ours}, YADE has {theirs}")
    print(f"{len(declared)} tables compared, {sum(map(len, declared.values()))} slots, {len(wrong)} differences")
    print("\n".join(wrong))
    return bool(wrong) or len(declared) < 37  # as many as there are: with fewer the dump has not been read


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
