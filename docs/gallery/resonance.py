"""Resonance of rocking blocks beside that of elastic oscillators, under pulse trains and harmonic motion: what Casapulla and Maione ask for in their
conclusion. `scripts/gallery resonance` runs it; the picture is written into the current folder, and the numbers are printed.

Amplification is the largest response over that to the first pulse alone: the rotation of a block, the displacement of an oscillator. Blocks are exact
under gravity. The impulse is the paper's, I = 0.0125 g s.
"""
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import masonry
from masonry import spectra

GRAVITY, IMPULSE, WIDTH, SLENDERNESS, PULSES, CYCLES = 9.81, 0.0125 * 9.81, 0.6, 5.0, 30, 20
RESTITUTIONS, DAMPINGS = (0.6, 0.7), (0.02, 0.05, 0.1)
BLOCKS, OSCILLATORS = ("C0", "C3"), ("0.2", "0.45", "0.65")
block = masonry.RockingBlock.from_size(WIDTH, WIDTH * SLENDERNESS)
one_pulse = masonry.PulseTrain(IMPULSE, times=[0.0])
figure, axes = plt.subplots(2, 2, figsize=(11, 8), layout="constrained")


def of_block(motion, first, restitution, blocks=block):
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = spectra.peak_ratio(blocks, motion, restitution) / spectra.peak_ratio(blocks, first, restitution)
    return np.where(np.isfinite(ratio), ratio, np.nan)


def draw(ax, x, y, colour, **options):
    """A curve, with a cross at each end beyond which the block overturns."""
    ax.plot(x, np.where(np.isfinite(y), y, np.nan), colour, **options)
    last = [k for k in range(len(y)) if np.isfinite(y[k]) and not np.all(np.isfinite(y[max(k - 1, 0):k + 2]))]
    ax.plot(np.asarray(x)[last], np.asarray(y)[last], "x", color=colour, markersize=8, markeredgewidth=2)


def of_oscillator(motion, first, period, damping):
    return spectra.oscillator_peak(motion, period, damping) / spectra.oscillator_peak(first, period, damping)


# Each system under the train that is resonant for it.
slendernesses = np.linspace(3, 12, 400)
own = {c: spectra.resonance(WIDTH, slendernesses, c) for c in RESTITUTIONS}
ax = axes[0, 0]
for c, colour in zip(RESTITUTIONS, BLOCKS):
    draw(ax, own[c]["gravity_period"], own[c]["gravity_amplification"], colour, label=f"block, C = {c}")
    ax.plot(own[c]["period"], own[c]["amplification"], colour, linestyle=":", label=f"block, C = {c}, constant moment (Eq. 13)")
    finite = own[c]["gravity_amplification"][np.isfinite(own[c]["gravity_amplification"])]
    print(f"own resonant train, C = {c}: the block is amplified by {finite.min():.0f} to {finite.max():.0f}, by {own[c]['amplification'][0]:.0f} under a constant moment")
for damping, colour in zip(DAMPINGS, OSCILLATORS):
    amplification = spectra.resonance(WIDTH, SLENDERNESS, 0.6, damping=damping)["oscillator_amplification"].item()
    ax.axhline(amplification, color=colour, linestyle="--", label=f"oscillator, damping {damping:.0%}")
    print(f"own resonant train, damping {damping:.0%}: the oscillator is amplified by {amplification:.1f}")
ax.set(title="each under its own resonant train", xlabel="stabilised period T* of the block, period of the oscillator (s)", ylabel="amplification")

# All systems under the train that is resonant for one block.
restitution = 0.7
history = masonry.simulate(block, masonry.PulseTrain(IMPULSE), restitution, half_cycles=PULSES)
train = masonry.PulseTrain(IMPULSE, times=[0.0, *history.impact_times[:PULSES - 1]])
stabilised = spectra.resonance(WIDTH, SLENDERNESS, restitution)["gravity_period"].item()
ax = axes[0, 1]
slender = np.unique(np.append(np.linspace(3, 5.85, 286), SLENDERNESS))
amplification = of_block(train, one_pulse, restitution, masonry.RockingBlock.from_size(WIDTH, WIDTH * slender))
draw(ax, spectra.resonance(WIDTH, slender, restitution)["gravity_period"], amplification, "C3", label=f"blocks, C = {restitution}, slenderness 3 to 5.85")
periods = np.linspace(0.3, 5, 300)
for damping, colour in zip(DAMPINGS, OSCILLATORS):
    values = of_oscillator(train, one_pulse, periods, damping)
    ax.plot(periods, values, color=colour, linestyle="--", label=f"oscillators, damping {damping:.0%}")
    print(f"train of the block of slenderness {SLENDERNESS:g}, T* = {stabilised:.2f} s: oscillators of damping {damping:.0%} are amplified most, by "
          f"{values.max():.1f}, at {periods[values.argmax()]:.2f} s")
half = slender[amplification > amplification.max() / 2]
print(f"blocks are amplified most, by {amplification.max():.1f}, at slenderness {slender[amplification.argmax()]:g}; by more than half of that only between "
      f"slenderness {half.min():.2f} and {half.max():.2f}")
ax.set(title=f"all under the resonant train of one block, T* = {stabilised:.2f} s", xlabel="stabilised period T* of the block, period of the oscillator (s)",
       ylabel="amplification")

# One block and one oscillator of the same period, under pulses at equal intervals and under harmonic motion.
relative = np.linspace(0.1, 2.5, 121)
for ax, title, label in ((axes[1, 0], "pulses at equal intervals", "two intervals over the period of the system"),
                         (axes[1, 1], f"harmonic motion, {CYCLES} cycles", "period of the motion over that of the system")):
    ax.set(title=title, xlabel=label, ylabel="amplification")
for c, colour in zip(RESTITUTIONS, BLOCKS):
    period = spectra.resonance(WIDTH, SLENDERNESS, c)["gravity_period"].item()
    found = np.array([of_block(masonry.PulseTrain(IMPULSE, times=ratio * period / 2 * np.arange(PULSES)), one_pulse, c) for ratio in relative])
    draw(axes[1, 0], relative, found, colour, label=f"block, C = {c}")
    print(f"equal intervals, C = {c}: the block is amplified by {found[np.abs(relative - 1).argmin()]:.2f} at its period T* and by at most {np.nanmax(found):.1f}, at "
          f"{relative[np.nanargmax(found)]:.2f} T*")
for times, style in ((1.2, "-"), (2.0, ":")):
    period = spectra.resonance(WIDTH, SLENDERNESS, 0.6)["gravity_period"].item()
    amplitude = times * GRAVITY / SLENDERNESS
    found = of_block(masonry.Sine(amplitude, 1 / (relative * period), CYCLES), masonry.HalfSine(amplitude, relative * period / 2), 0.6)
    draw(axes[1, 1], relative, found, "C0", linestyle=style, label=f"block, C = 0.6, {times:g} times the amplitude of uplift")
    overturns = relative[~np.isfinite(found)]
    print(f"harmonic motion of {times:g} times the amplitude of uplift: the block is amplified by {np.nanmin(found):.1f} to {np.nanmax(found):.1f} and overturns from "
          f"{overturns.min():.2f} T* on")
for damping, colour in zip(DAMPINGS, OSCILLATORS):
    for ax, pair in ((axes[1, 0], lambda x: (masonry.PulseTrain(IMPULSE, times=x / 2 * np.arange(PULSES)), one_pulse)),
                     (axes[1, 1], lambda x: (masonry.Sine(1.0, 1 / x, CYCLES), masonry.HalfSine(1.0, x / 2)))):
        ax.plot(relative, [of_oscillator(*pair(x), 1.0, damping) for x in relative], color=colour, linestyle="--", label=f"oscillator, damping {damping:.0%}")
for ax in axes.flat:
    ax.set_yscale("log")
    ax.set_yticks([1, 2, 5, 10, 20, 50, 100], [1, 2, 5, 10, 20, 50, 100])
    ax.minorticks_off()
    ax.grid(alpha=0.3)
    if any(line.get_marker() == "x" and len(line.get_xdata()) for line in ax.lines):
        ax.plot([], [], "x", color="0.3", markersize=8, markeredgewidth=2, label="the block overturns beyond")
    ax.legend(fontsize=7)
axes[0, 0].set_ylim(bottom=1.5)  # room for the legends
axes[1, 1].set_ylim(top=150)
figure.savefig("resonance.png", dpi=100)
