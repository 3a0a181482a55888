#!/usr/bin/env python3
"""Cross-check of `handloop identify --method paper` by SciPy.

    scipy_cross_check.py PROGRAM [RECORDINGS PER AXIS]

Makes recordings of random arms within the ranges of Table III (coloured noise, a device in the hand, wander, noise,
quantisation), lets the program fit them, and fits them anew here: scipy.signal for spectra and coherence with the settings of
docs/identification.md, scipy.optimize for eq. (2) from many random starts. Every parameter must agree within 0.2 %.

Exit code 0: agrees; 1: does not; 77: NumPy or SciPy is missing (ctest then reports the test as skipped).
"""
import csv
import os
import subprocess
import sys
import tempfile

try:
    import numpy as np
    from scipy import linalg, optimize, signal
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

NAMES = ["mass_kg", "k1_N_per_m", "k2_N_per_m", "b1_Ns_per_m", "b2_Ns_per_m"]
# Table III: minimum, mean, maximum, standard deviation
RANGES = {
    "x": [(0.0340, 0.3240, 0.8016, 0.1464), (140.6, 459.4, 757.9, 144.5), (53.05, 104.8, 196.2, 27.59),
          (0.0020, 2.579, 7.095, 1.337), (3.148, 5.920, 10.34, 2.192)],
    "y": [(0.2275, 0.4763, 0.9115, 0.1528), (292.3, 620.2, 926.5, 185.8), (88.66, 132.5, 199.7, 29.05),
          (3.830, 6.094, 9.898, 1.403), (4.020, 5.890, 9.721, 1.398)],
    "z": [(0.0003, 0.2357, 0.4810, 0.1261), (590.3, 886.9, 1050, 105.4), (194.6, 365.8, 588.7, 105.8),
          (0.0002, 0.5241, 1.939, 0.4884), (10.66, 20.14, 28.88, 5.129)],
}
TOLERANCE = 0.002
T, ROWS = 0.001, 60000


def draw(axis, rng):
    arm = []
    for low, mean, high, deviation in RANGES[axis]:
        while True:
            value = rng.normal(mean, deviation)
            if low <= value <= high:
                break
        arm.append(value)
    return arm


def record(arm, rng):
    """60 s at 1 kHz: a held command through a device of 75 g that the hand holds."""
    M, k1, k2, b1, b2 = arm
    m, b = 0.075, 0.05
    sos = signal.butter(13, 30, fs=1 / T, output="sos")
    command = signal.sosfilt(sos, rng.normal(size=ROWS + 2000))[2000:]
    command = np.clip(1.25 * command / command.std(), -5, 5)
    A = np.array([[0, 1, 0, 0], [-k1 / m, -(b1 + b) / m, k1 / m, b1 / m], [0, 0, 0, 1],
                  [k1 / M, b1 / M, -(k1 + k2) / M, -(b1 + b2) / M]])
    B = np.array([[0], [1 / m], [0], [0]])
    e = linalg.expm(np.block([[A, B], [np.zeros((1, 5))]]) * T)
    Phi, Gamma = e[:4, :4], e[:4, 4]
    x, states = np.zeros(4), np.empty((ROWS, 4))
    for n in range(ROWS):
        states[n] = x
        x = Phi @ x + Gamma * command[n]
    force = k1 * (states[:, 0] - states[:, 2]) + b1 * (states[:, 1] - states[:, 3])
    wander = signal.sosfilt(signal.butter(2, 0.3, fs=1 / T, output="sos"), rng.normal(size=ROWS))
    position = states[:, 0] + 3e-4 * wander / wander.std()
    force = np.round((force + 0.003 * rng.normal(size=ROWS)) / 5.2e-4) * 5.2e-4
    return force, np.round(position / 3e-5) * 3e-5


def response(arm, s):
    M, k1, k2, b1, b2 = arm
    return (M * s**2 + (b1 + b2) * s + k1 + k2) / (b1 * M * s**3 + (b1 * b2 + k1 * M) * s**2 + (b2 * k1 + b1 * k2) * s + k1 * k2)


def fit(force, position, rng):
    """Eq. (2) by Welch spectra of 1914 samples, half overlapping, symmetric Hamming, bins 1 to 57; best of many starts."""
    u, y = force - force.mean(), position - position.mean()
    settings = dict(fs=1 / T, window=signal.windows.hamming(1914, sym=True), noverlap=957, detrend=False)
    f, cross = signal.csd(u, y, **settings)
    power = signal.welch(u, **settings)[1]
    weight = signal.coherence(u, y, **settings)[1][1:58]
    H, s = (cross / power)[1:58], 2j * np.pi * f[1:58]
    scale = np.array([0.25, 500.0, 150.0, 2.0, 8.0])
    root = 1e3 * np.sqrt(weight)

    def residuals(x):
        r = root * (H - response(x * scale, s))
        return np.concatenate([r.real, r.imag])

    best = None
    for _ in range(25):
        start = np.exp(rng.uniform(np.log(0.1), np.log(3), 5))
        result = optimize.least_squares(residuals, start, bounds=(4e-6, np.inf), x_scale="jac", ftol=1e-14, xtol=1e-13, gtol=1e-14,
                                        max_nfev=300)
        if best is None or result.cost < best.cost:
            best = result
    return best.x * scale, 2 * best.cost * 1e-6


def main():
    program, count = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 6
    rng = np.random.default_rng(20)
    worst, lines = 0.0, []
    with tempfile.TemporaryDirectory() as directory:
        recordings = []
        with open(f"{directory}/index.csv", "w") as index:
            index.write("trial,subject,grip,axis\n")
            for axis in "xyz":
                for _ in range(count):
                    arm = draw(axis, rng)
                    recordings.append((axis, *record(arm, rng)))
                    trial = len(recordings)
                    index.write(f"{trial},{trial},1,{axis}\n")
                    np.savetxt(f"{directory}/trial_{trial:03d}.csv", np.column_stack([np.arange(ROWS) * T, *recordings[-1][1:]]),
                               delimiter=",", header="time_s,force_N,position_m", comments="", fmt=["%.3f", "%.17g", "%.17g"])
        subprocess.run([program, "identify", "--index", f"{directory}/index.csv", "--method", "paper", "--out", f"{directory}/out"],
                       check=True, stdout=subprocess.DEVNULL)
        with open(f"{directory}/out/fits.csv") as file:
            rows = list(csv.DictReader(file))
    for row, (axis, force, position) in zip(rows, recordings):
        here, cost = fit(force, position, rng)
        there = np.array([float(row[name]) for name in NAMES])
        # A parameter that ended at zero is compared with what is usual for it.
        usual = np.array([r[1] for r in RANGES[axis]])
        difference = np.abs(there - here) / np.maximum(np.abs(here), 1e-3 * usual)
        worst = max(worst, difference.max())
        if difference.max() > TOLERANCE:
            lines.append(f"trial {row['trial']} axis {axis}: {NAMES[difference.argmax()]} differs by {100 * difference.max():.3f} %; "
                         f"costs {float(row['cost']):.9g} here, {cost:.9g} SciPy")
    print(f"{len(rows)} recordings, largest difference {100 * worst:.4f} % (limit {100 * TOLERANCE} %)")
    print("\n".join(lines))
    sys.exit(1 if lines else 0)


if __name__ == "__main__":
    main()
