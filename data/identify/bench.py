"""Makes bench1.csv and bench2.csv: a small motor under a multisine, for docs/tutorials/from-lab-data.md.

J dv/dt = 0.068 i(t - 2.6 ms) - 0.02 - 3e-3 v - 0.06 sgn(v), J = 1.2e-3 kg m2. The current i is in A. The encoder has 4096 counts, and noise of 0.3 counts before it. bench1.csv has some damage.
"""

import math
import pathlib
import random

J, C, COULOMB, OFFSET, DELAY_S, K = 1.2e-3, 3e-3, 0.06, 0.02, 2.6e-3, 0.068
FREQUENCIES = [0.5, 1.1, 1.7, 2.9, 4.3, 7.1, 11.3]


def record(seed, rate=500, duration_s=6.0):
    rng = random.Random(seed)
    phases = [rng.uniform(0, 2 * math.pi) for _ in FREQUENCIES]
    times = [round((k + rng.uniform(-0.03, 0.03)) / rate, 6) for k in range(int(duration_s * rate))]
    currents = [
        round(sum(3.5 * math.sin(2 * math.pi * f * t + p) for f, p in zip(FREQUENCIES, phases)), 5)
        for t in times
    ]
    rows, q, v, i = [], 0.3, 0.0, 0
    now = times[0]
    for t, current in zip(times, currents):
        while now < t:
            while i + 1 < len(times) and times[i + 1] + DELAY_S <= now:
                i += 1
            step = t - now
            if i + 1 < len(times):
                step = min(step, times[i + 1] + DELAY_S - now)
            torque = K * currents[i] - OFFSET
            if v == 0 and abs(torque) <= COULOMB:
                now += step
                continue
            # In closed form, until standstill at most.
            end = (torque - math.copysign(COULOMB, v if v != 0 else torque)) / C
            if v != 0 and v * end < 0:
                step = min(step, J / C * math.log(1 - v / end))
            after = end + (v - end) * math.exp(-C / J * step)
            q += end * step + (v - after) * J / C
            v = 0.0 if abs(after) < 1e-12 else after
            now += step
        counts = round(q / (2 * math.pi / 4096) + rng.gauss(0, 0.3))
        rows.append(f"{t:.6f},{current:.5f},{counts}")
    return rows


def write(name, rows):
    file = pathlib.Path(__file__).with_name(name)
    file.write_text("# a motor under a multisine: docs/tutorials/from-lab-data.md\ntime_s,u,y\n" + "\n".join(rows) + "\n")


if __name__ == "__main__":
    damaged = record(1)
    del damaged[700:703]
    damaged.insert(1200, damaged[1200])
    damaged[1800], damaged[1801] = damaged[1801], damaged[1800]
    damaged[2100] = damaged[2100].rsplit(",", 1)[0] + ",NaN"
    write("bench1.csv", damaged)
    write("bench2.csv", record(2))
