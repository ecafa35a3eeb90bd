"""The tables of one run, and how they get between the markers of README.md."""
from pathlib import Path

import judge
import theory
from cases import COMPLIANT, RIGID, grid, relative_error

README = Path(__file__).resolve().parent / "README.md"
BEGIN, END = "<!-- written by validation/paper/run --readme: begin -->", "<!-- end -->"


def _table(header, rows):
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(str(cell).replace("|", "\\|") for cell in line) + " |" for line in lines)


def _nearest():
    """The case of the figures whose slenderness is nearest to an exact overturning limit, in words."""
    limits = {(c.two_b, c.restitution): theory.exact_critical_slenderness(c.two_b, c.restitution) for c in grid()}
    distance, case = min(((relative_error(c.slenderness, limits[c.two_b, c.restitution]), c) for c in grid()), key=lambda pair: pair[0])
    return (f"Nearest to overturning under gravity: 2b = {case.two_b} m, lambda = {case.slenderness}, C = {case.restitution}, "
            f"{distance:.1%} from its limit.")


def _models(table):
    """Figs 4 to 8 by rigid blocks and by compliant joints, side by side."""
    rows = [[rigid[0], *rigid[1:3], *compliant[1:3]] for rigid, compliant in zip(judge.spectra(table, RIGID), judge.spectra(table, COMPLIANT))]
    rows += [[rigid[0], rigid[1], "", compliant[1], ""] for rigid, compliant in zip(judge.cost(table, RIGID), judge.cost(table, COMPLIANT))]
    return _table(["", "rigid", "bound", "compliant", "bound"], rows)


def tables(stated, table, others):
    """others: verdicts that are not in the table of the two models."""
    claims = _table(["where", "the text", "paper", "closed form", "real gravity", "verdict"],
                    [[c.where, c.statement, c.paper, c.closed_form, c.gravity, c.verdict] for c in stated])
    checks = _table(["what must hold", "value", "bound", "holds"], [[*v[:3], "yes" if v[3] else "NO"] for v in others])
    return (f"### The paper's text against its closed form and real gravity\n\n{claims}\n\n"
            f"### Figures 4 to 8 in YADE\n\n{len(grid())} blocks by each model, at the settings that `dem.engines()` chooses. {_nearest()}\n\n{_models(table)}\n\n"
            f"### The other verdicts\n\n{checks}")


def update(generated):
    text = README.read_text()
    before, rest = text.split(BEGIN)
    README.write_text(f"{before}{BEGIN}\n\n{generated}\n\n{END}{rest.split(END)[1]}")
