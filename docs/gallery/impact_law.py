"""Figure of docs/impact-law.md: where the impulse of a rocking impact acts, how much friction it takes and what energy stays.
`scripts/gallery impact_law` runs it; the picture is written into the current folder."""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import masonry

restitution = np.linspace(0, 1, 201)
figure, (place, friction) = plt.subplots(1, 2, figsize=(8, 3.4), layout="constrained")
for half_height, colour in ((0.4, "tab:blue"), (0.8, "tab:orange"), (1.5, "tab:green")):
    block = masonry.RockingBlock(0.2, half_height)
    slenderness, natural = float(block.slenderness), float(block.natural_restitution)
    label = f"slenderness {slenderness:g}"
    place.plot(restitution, 4 / 3 * (1 + slenderness**2) * (restitution - natural) / (1 + restitution), color=colour, label=label)
    place.plot(natural, 0, "o", color=colour)
    friction.plot(restitution, slenderness * (1 - restitution) / (1 + restitution), color=colour, label=label)
place.axhspan(0, 2, color="0.92")
place.text(0.03, 1.6, "inside the base", color="0.4", fontsize="small")
place.set(xlim=(0, 1), ylim=(-6, 2), xlabel="restitution C", ylabel="distance inward of the new pivot / half width", title="where the impulse acts")
place.legend(fontsize="small", loc="lower right")
friction.axhline(0.65, color="0.6", linestyle="--", linewidth=1)
friction.text(0.98, 0.68, "stone, 0.65", color="0.4", ha="right", fontsize="small")
friction.set(xlim=(0, 1), ylim=(0, 2), xlabel="restitution C", ylabel="friction coefficient", title="friction that a no-slip impact needs")
figure.savefig("impact_law.png", dpi=110)
