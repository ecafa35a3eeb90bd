"""Small files of records, each written as its format's definition says, from a signal that the test knows. No file of anybody else is used."""

import numpy as np

DT = 0.01


def signal(count=50, amplitude=2.0):
    """m/s^2, rounded so that every format can hold it: 1e-5 m/s^2 is 1e-3 gal."""
    t = DT * np.arange(count)
    return np.round(amplitude * np.sin(9 * t) * np.exp(-t), 5)


def rows(values, form, per_line):
    texts = [form(value) for value in values]
    return "".join("".join(texts[k:k + per_line]) + "\n" for k in range(0, len(texts), per_line))


def fortran(width, decimals, exponent=None):
    """The form F{width}.{decimals}, with a leading zero dropped, or with an exponent as `E` or `D` writes it."""
    if exponent:
        return lambda value: f"{value:{width}.{decimals}E}".replace("E", exponent)
    return lambda value: f"{value:.{decimals}f}".replace("0.", ".", 1).rjust(width) if abs(value) < 1 else f"{value:{width}.{decimals}f}"


def at2(values, unit="ACCELERATION TIME SERIES IN UNITS OF G", points="NPTS={count:6d}, DT= {dt:.4f} SEC", title="A QUAKE, 1/1/1990, SOME STATION, 090",
        form=fortran(15, 7, "E"), before=(), after=(), per_line=5):
    header = ["PEER NGA STRONG MOTION DATABASE RECORD", title, *before, unit, *after, points.format(count=len(values), dt=DT)]
    return "\n".join(header) + "\n" + rows(values, form, per_line)


def esm(values, units="cm/s^2", stream="HNE", kind="ACCELERATION", count=None, skip=(), form="{:.6f}"):
    header = [("EVENT_NAME", "SOMEWHERE"), ("EVENT_ID", "XX-1990-0001"), ("EVENT_DATE_YYYYMMDD", "19900101"), ("NETWORK", "XX"), ("STATION_CODE", "ABC"),
              ("STATION_ELEVATION_M", ""), ("VS30_M/S", ""), ("SAMPLING_INTERVAL_S", f"{DT:.6f}"), ("NDATA", str(len(values) if count is None else count)),
              ("DURATION_S", f"{DT * len(values):.3f}"), ("STREAM", stream), ("UNITS", units), ("INSTRUMENT_ANALOG/DIGITAL", "D"), ("PGA_CM/S^2", "1.0"),
              ("HEADER_FORMAT", "DYNA 1.2"), ("DATA_TYPE", kind), ("DATA_TIMESTAMP_YYYYMMDD_HHMMSS", "20200101_000000.000"), ("USER5", "")]
    return "".join(f"{key}: {value}\n" for key, value in header if key not in skip) + "".join(form.format(value) + "\n" for value in values)


def afad(columns, unit="gal", count=None):
    head = ["STRONG GROUND MOTION RECORDS OF TURKIYE", "PLACE                   : SOMEWHERE", "EARTHQUAKE DATE         : 1990/01/01 00:00:00 (GMT)",
            "STATION ID              : 1234", "STATION ALTITUDE (m)    : 735", f"NUMBER OF DATA          : {len(columns[0]) if count is None else count}",
            f"SAMPLING INTERVAL (sec) : {DT}", f"RAW PGA VALUES ({unit})    : (N-S) 1 (E-W) 1 (U-D) 1", "Copyright SOMEBODY", "       N-S          E-W          U-D"]
    return "\n".join(head) + "\n" + "".join("".join(f"{value:12.6f} " for value in row) + "\n" for row in zip(*columns))


def knet(counts, direction="N-S", factor="3920(gal)/6182761", rate="100Hz", seconds=None, memo="Memo.             ", code="ABC001"):
    head = ["Origin Time       1990/01/01 00:00:00", "Lat.              38.103", "Long.             142.860", "Depth. (km)       24", "Mag.              6.0",
            f"Station Code      {code}", "Station Lat.      36.1256", "Station Long.     140.0901", "Station Height(m) 27",
            "Record Time       1990/01/01 00:00:10", f"Sampling Freq(Hz) {rate}", f"Duration Time(s)  {DT * len(counts) if seconds is None else seconds:g}",
            f"Dir.              {direction}", f"Scale Factor      {factor}", "Max. Acc. (gal)   100.0", "Last Correction   1990/01/01 00:00:00", memo]
    return "\n".join(head) + "\n" + rows(counts, lambda value: f"{value:9d}", 8)


def smc(values, kind="2 CORRECTED ACCELEROGRAM", unknown=(-32768, 1.7e38), comments=("", "a comment"), count=None, rate=1 / DT, station="ABC", form=None):
    integers = [unknown[0]] * 48
    integers[15], integers[16] = len(comments) if comments else unknown[0], len(values) if count is None else count
    reals = [unknown[1]] * 50
    reals[1] = rate
    text = [kind, "*", "A001", "     1990   1   1    0000 Somewhere, XX", "Moment Mag=      6.0", f"station = {station}   component=   up",
            "epicentral dist =     63.0       pk     =     84.5", "inst type=SMA-1      data source = XXXX", "*", "*", "*"]
    body = rows(integers, lambda value: f"{value:10d}", 8) + rows(reals, lambda value: f"{value:15.7E}", 5)
    body += "".join(f"|{comment}\n" for comment in comments)
    short = form or (lambda value: f"{value:10.4E}".replace("E+0", "E+").replace("E-0", "E-").rjust(10))
    return "\n".join(line.ljust(80) for line in text) + "\n" + body + rows(values, short, 8)


def csmip_2(channels, unit=", in cm/sec2. (8f10.3)", quantities=("accel", "veloc", "displ"), count=None, form=fortran(10, 3)):
    """channels: {(number, direction): (accelerations, velocities, displacements)} in cm and s."""
    text = ""
    for (number, direction), motions in channels.items():
        text += (f"Corrected accelerogram   89146-L2500-12044.02       Chan  {number}: {direction}     from   \n"
                 "Uncorrected Accelerogram Data             Processed: 01/01/90, XXX\nRecord of Mon Jan 01, 1990\n"
                 "Station No. 89146   40.941N, 123.633W      Etna  s/n 2500  (3 Chns of  3 at Sta)\nSome Creek                              CGS\n"
                 f" {len(motions[0])} points of instrument- and baseline-corrected accel, veloc and displ data\nAt equally-spaced intervals of    .010  sec.\n"
                 "   -1  100    1    3    3  200\n  .0108814  .6700000 66.000000-999.00000\n")
        for quantity, values, power in zip(quantities, motions, ("sec2", "sec", "")):
            said = unit if quantity == "accel" else f", in cm{'/' + power if power else ''}.   (8f10.3)"
            text += f" {len(values) if count is None else count} points of {quantity} data equally spaced at  .010 sec{said}\n" + rows(values, form, 8)
        text += f"/&  ----------  End of data for channel  {number}  ----------\n"
    return text


def csmip_1(values, unit="in units of g .", direction="360 Deg"):
    return ("Uncorrected Accelerogram Data             Processed: 01/01/90, XXX\nRecord of Mon Jan 01, 1990\n"
            "Station No. 89146   40.941N, 123.633W      Etna  s/n 2500  (3 Chns of  3 at Sta)\nSome Creek                              CGS\n"
            f"Chan  1: {direction}\nNo. of Points =  {len(values)}  Record Length = 66.000 sec   at 100 Samples/sec\nUnits of uncor data are sec and g .\n"
            f" {len(values)} Accelerogram points at 100 pts/sec {unit}      Format: (8f9.6)\n" + rows(values, fortran(9, 6), 8)
            + "/&  ----------  End of data for channel  1  ----------\n")


def cosmos(values, kind="acceleration", units="cm/sec2(04)", reals=(), count=None, direction=" 90 deg", channel="1", scnl="", first="Corrected", form=None,
           seconds=None):
    """reals: {number of the real-header value: value}; others are unknown."""
    header = [-999.0] * 100
    for place, value in dict(reals or {62: 1e3 * DT, 63: DT * len(values)}).items():
        header[place - 1] = value
    seconds = int(DT * len(values)) if seconds is None else seconds
    lines = [f"{first} {kind}    (Format v01.20 with 13 text lines)", "Record of Somewhere Earthquake", "Hypocenter: 61.3 -149.9 H= 46km Mw=7.0",
             "Origin: 1990/01/01", "Statn No: 37-000011 Code:XX-ABC     XXX  Some River", "Coords: 60.9 -144.6",
             "Recorder: (see cmnt)      ( ? Chns of   3 at Sta)", "Rcrd start time: 1990/01/01",
             f"Sta Chan   {channel}:{direction} (Rcrdr Chan  {channel}) Location:", "Raw record length = 210.000 sec", "Processed:1990-01-01",
             "Record filtered below  0.03 Hz", "Values used when parameter or data value is unknown/unspecified:   -999, -999.00",
             " 100 Integer-header values follow on  10 lines, Format= (10I8)"]
    text = "\n".join(lines) + "\n" + rows([-999] * 100, lambda value: f"{value:8d}", 10) + " 100 Real-header values follow on  20 lines, Format= (5F15.6)\n"
    text += rows(header, lambda value: f"{value:15.6f}", 5)
    text += f"   1 Comment line(s) follow, each starting with a \"|\":\n|{'<SCNL>' + scnl if scnl else ' nothing'}\n"
    text += f"   {len(values) if count is None else count} {kind} pts, approx  {seconds} secs, units={units},Format=(8F10.5)\n"
    return text + rows(values, form or fortran(10, 5), 8) + f"End-of-data for Chan  {channel} {kind}\n"
