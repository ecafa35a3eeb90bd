"""Rocking spectra of two blocks under one sine, and response spectra of three records. `scripts/gallery spectra` runs it; the pictures are
written into the current folder."""
import numpy as np

import masonry
from masonry import spectra

rocking = spectra.rocking(masonry.Sine, amplitude=np.linspace(1, 10, 91), frequency=np.linspace(0.3, 5, 95), width=[0.4, 0.8], slenderness=5)
rocking.plot("rocking_spectrum.png", x="frequency", y="amplitude")
records = [masonry.artificial_record(seed, peak=3.0) for seed in range(3)]
response = spectra.response(records, np.geomspace(0.05, 4, 200), damping=0.05)
response.plot("response_spectrum.png", "pseudo_acceleration", x="period")
