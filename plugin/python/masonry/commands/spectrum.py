"""masonry spectrum rocking | overturning | response | resonance: spectra of blocks and oscillators."""

import argparse

from . import _given

_MOTIONS = {"sine": "Sine", "half-sine": "HalfSine", "rectangular": "Rectangular"}


def add(subcommands):
    parser = subcommands.add_parser("spectrum", help="spectra of rocking blocks and elastic oscillators",
                                    description="Computes a spectrum and writes it as a table and a picture. masonry spectrum KIND --help shows an example.")
    kinds = parser.add_subparsers(title="kinds", metavar="KIND", required=True)

    one = _kind(kinds, "rocking", "largest rotation over the critical angle, and what overturns",
                "masonry spectrum rocking --motion sine --amplitude 1:8:30 --frequency 0.5:4:30 --width 0.4 --slenderness 5")
    _add_motion(one)
    _add_block(one)
    _given.add_output(one, "rocking")
    one.set_defaults(run=_rocking)

    one = _kind(kinds, "overturning", "least amplitude that overturns",
                "masonry spectrum overturning --motion half-sine --duration 0.2:1.5:14 --width 0.4,0.8 --slenderness 5")
    _add_motion(one)
    _add_block(one)
    _given.add_output(one, "overturning")
    one.set_defaults(run=_overturning)

    one = _kind(kinds, "response", "response spectra of elastic oscillators under records",
                "masonry spectrum response quake.AT2 --period 0.05:4:200 --damping 0.02,0.05")
    _given.add_records(one, "+")
    one.add_argument("--period", type=_given.numbers, default=_given.numbers("0.05:4:200:log"), help="s (default: 0.05:4:200:log)")
    one.add_argument("--damping", type=_given.numbers, default=0.05, help="ratio (default: 0.05)")
    _given.add_output(one, "response")
    one.set_defaults(run=_response)

    one = _kind(kinds, "resonance", "stabilised phase of blocks and oscillators under the resonant train of Casapulla and Maione",
                "masonry spectrum resonance --width 0.4,0.6,1.2 --slenderness 3:12:91 --restitution 0.7")
    _add_block(one, natural=False)
    one.add_argument("--impulse", type=_given.numbers, default=0.0125 * 9.81, help="I, m/s (default: 0.0125 g s)")
    one.add_argument("--damping", type=_given.numbers, default=0.05, help="ratio of the oscillator (default: 0.05)")
    _given.add_output(one, "resonance")
    one.set_defaults(run=_resonance)


def _kind(kinds, name, help, example):
    return kinds.add_parser(name, help=help, description=f"{help[0].upper()}{help[1:]}.", formatter_class=argparse.RawDescriptionHelpFormatter,
                            epilog=f"Lists of {_given.NUMBERS}.\n\nexample:\n  {example}")


def _add_motion(parser):
    _given.add_records(parser, "*", "; in place of --motion")
    parser.add_argument("--motion", choices=tuple(_MOTIONS))
    for name, unit in (("amplitude", "m/s^2"), ("frequency", "Hz, of a sine"), ("cycles", "of a sine (default: 1)"),
                       ("duration", "s, of a half sine or rectangle"), ("scale", "factors of a record")):
        parser.add_argument(f"--{name}", type=_given.numbers, help=unit)


def _add_block(parser, natural=True):
    parser.add_argument("--width", type=_given.numbers, required=True, help="whole width 2b, m")
    parser.add_argument("--slenderness", type=_given.numbers, required=True, help="height over width")
    parser.add_argument("--restitution", type=_given.numbers, required=not natural, help="C" + (" (default: the natural one)" if natural else ", below 1"))


def _motion(given):
    """(motion, its numbers) for masonry.spectra"""
    import masonry

    numbers = {name: getattr(given, name) for name in ("amplitude", "frequency", "cycles", "duration", "scale") if getattr(given, name) is not None}
    if bool(given.records) == bool(given.motion):
        raise ValueError("give --motion or one record")
    if given.motion:
        return getattr(masonry, _MOTIONS[given.motion]), numbers
    if len(given.records) > 1:
        raise ValueError(f"{len(given.records)} records were given: a spectrum of blocks is that of one record")
    return _given.read_records(given)[0], numbers


def _rocking(given):
    from masonry import spectra

    motion, numbers = _motion(given)
    result = spectra.rocking(motion, given.width, given.slenderness, given.restitution, progress=_given.progress(given), **numbers)
    dims = [name for name in result.dims if name in ("frequency", "duration", "amplitude", "scale")]
    print(f"masonry: {result['overturned'].sum()} of {result['overturned'].size} cases overturn")
    _given.write(result, given, **({"x": dims[1], "y": dims[0]} if len(dims) > 1 else {}))


def _overturning(given):
    from masonry import spectra

    motion, numbers = _motion(given)
    _given.write(spectra.overturning(motion, given.width, given.slenderness, given.restitution, progress=_given.progress(given), **numbers), given)


def _response(given):
    from masonry import spectra

    records = _given.read_records(given)
    _given.write(spectra.response(records if len(records) > 1 else records[0], given.period, given.damping, progress=_given.progress(given)), given,
                 value="pseudo_acceleration", x="period")


def _resonance(given):
    from masonry import spectra

    result = spectra.resonance(given.width, given.slenderness, given.restitution, given.impulse, given.damping)
    _given.write(result, given, value="gravity_ratio", x="period")
