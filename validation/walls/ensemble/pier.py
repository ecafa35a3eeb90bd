"""The scene: a pier of four blocks on a base that follows an artificial record."""
import math

LAWS = {
    "localised": dict(method="localised", impact_order="sequential", dt=1e-3),
    "compliant": dict(penetration=3e-5, impact_order="sequential"),
    "compliant, soft": dict(penetration=3e-4, impact_order="sequential"),
}


def run(case):
    from masonry import artificial_record, dem, results
    from yade import O

    record = artificial_record(case["seed"], case["peak"] * 9.81, duration=5, frequency=1.5)
    stone = dem.BlockMat(density=2000, frictionAngle=math.atan(0.7), restitution=case["restitution"])
    base = dem.base((6, 2, 0.2), stone)
    dem.pier(4, (0.40, 0.50, 0.40), stone, on=base)
    motion = dem.record_motion(record, ids=[base])
    recorder = dem.WallRecorder(virtPeriod=0.02)
    O.engines = dem.engines(motion, recorder=recorder, **LAWS[case["law"]])
    O.run(math.ceil(6 / O.dt), True)
    return results.collapse(dem.wall_history(recorder)).numbers()
