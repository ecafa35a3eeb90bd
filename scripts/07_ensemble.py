"""A dry wall with a window under many artificial records: how often it collapses, and how far it drifts. Each case runs in a YADE
process of its own; a second call computes only what is missing. Run with
`PYTHONPATH=build/python /usr/bin/python3 scripts/07_ensemble.py [records for each size]`."""
import math


def run(case):
    """Called in YADE, with one of the cases below."""
    from masonry import artificial_record, dem, results
    from yade import O

    record = artificial_record(case["seed"], case["peak"] * 9.81, duration=6, frequency=1.5)
    stone = dem.BlockMat(density=2000, frictionAngle=math.atan(0.65))  # natural restitution
    base = dem.base((6, 2, 0.2), stone)
    dem.wall(courses=10, per_course=5, size=(0.40, 0.20, 0.175), material=stone, on=base, openings=[(0.6, 0.525, 0.8, 0.7)])
    motion = dem.record_motion(record, ids=[base])
    recorder = dem.WallRecorder(virtPeriod=0.02)
    O.engines = dem.engines(motion, recorder=recorder)
    O.run(math.ceil((record.duration + 1) / O.dt), True)
    return results.collapse(dem.wall_history(recorder)).numbers()


if __name__ == "__main__":
    import argparse

    from masonry import ensemble

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("records", nargs="?", type=int, default=10, help="for each size (10)")
    records = parser.parse_args().records
    cases = [{"peak": peak, "seed": seed} for peak in (0.8, 1.0, 1.2) for seed in range(records)]  # peak acceleration in g
    table = ensemble.run(__file__, cases, "results/07_ensemble")
    print("peak (g)  cases  collapsed, 95 % interval    median of the peak drift, 95 % interval")
    for row in ensemble.statistics(table, by="peak", probabilities=(0.5,)):
        print(f"{row['peak']:8.2f}  {row['cases']:5d}  {row['fraction']:.2f}  {row['fraction_low']:.2f} to {row['fraction_high']:.2f}        "
              f"{row['quantile_0.5']:.4f}  {row['quantile_0.5_low']:.4f} to {row['quantile_0.5_high']:.4f}")
    print("wrote results/07_ensemble/ensemble.csv")
