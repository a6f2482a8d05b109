"""The sea: its spectrum, its realisations and the laws of water. The spectral model of the wave force: its fit, bank,
process and filter."""

import unittest

import numpy as np
from scipy.linalg import solve_discrete_lyapunov
from scipy.signal import lfilter
from scipy.spatial.transform import Rotation

import methods
from methods import AxisNoise, ForceSpectrum, Resonator, SeaState, WaveForceBank, WaveForceBankDesign, Waves
from support import near

GRAVITY, PERIOD_S, DEPTH_M = 9.806, 0.01, 10
VERTICAL = AxisNoise(mass_kg=1.38, position_std_m=0.1, velocity_std_m_s=2e-4, bias_std_N=5e-4, period_s=PERIOD_S)


def sea(**keys):
    return SeaState(**{"significant_height_m": 2.0, "peak_period_s": 8.0, "heading_rad": 0.6} | keys)


class Jonswap(unittest.TestCase):
    def test_the_significant_height_is_four_times_the_root_of_m0(self):
        for gamma in (1, 3.3, 7):
            density = methods.JonswapSpectrum(sea(gamma=gamma)).density(np.arange(5e-4, 30, 1e-3))
            near(4 * np.sqrt(1e-3 * density.sum()), 2, atol=0.02)

    def test_without_peak_enhancement_it_is_pierson_moskowitz(self):
        """Its integral has a closed form: S = 5/16 H_s² ω_p⁴ ω⁻⁵ exp(−5/4 (ω_p/ω)⁴)."""
        spectrum = methods.JonswapSpectrum(sea(significant_height_m=3, peak_period_s=10, gamma=1))
        wp, w = 2 * np.pi / 10, np.array([0.4, 0.63, 1, 2])
        closed = 5 / 16 * 9 * wp**4 * w**-5 * np.exp(-1.25 * (wp / w)**4)
        near(spectrum.density(w) / closed, 1, atol=1e-6)

    def test_it_peaks_at_the_peak_period(self):
        w = np.arange(0.2, 3, 1e-4)
        for period_s in (6, 8, 10):
            peak = w[np.argmax(methods.JonswapSpectrum(sea(peak_period_s=period_s)).density(w))]
            near(peak / (2 * np.pi / period_s), 1, atol=1e-3)


class Water(unittest.TestCase):
    def test_the_acceleration_has_its_mean_frequency_above_the_peak(self):
        """Σ g ω / Σ g of a sea's components, where g is the squared acceleration of a component."""
        for depth in (0, 5, 10, 40):
            for water in (0, 50):
                state = sea(water_depth_m=water, components=1000)
                a, w, k = np.array([(c.amplitude_m, c.omega_rad_s, c.wave_number_rad_m)
                                    for c in Waves(state).components()]).T
                decay = np.sinh(k * (water - depth)) / np.sinh(k * water) if water else np.exp(-k * depth)
                near(methods.mean_acceleration_frequency(state, depth) / np.average(w, weights=(a * w * w * decay)**2), 1,
                     atol=2e-3)
        # It falls with depth, towards the peak frequency.
        at_0, at_10 = (methods.mean_acceleration_frequency(sea(), depth) for depth in (0, 10))
        self.assertTrue(at_0 > at_10 > 2 * np.pi / 8)
        self.assertRaises(ValueError, methods.mean_acceleration_frequency, sea(), -1)

    def test_an_hour_has_the_significant_height(self):
        for seed in (1, 2, 3):
            near(4 * np.sqrt(np.mean(Waves(sea(seed=seed)).elevation(0.5 * np.arange(7200), 0, 0)**2)), 2, atol=0.1)

    def test_the_spectrum_is_recovered(self):
        """The Fourier transform of an hour, over the components' bands. The difference is the leakage of the transform."""
        energy = 2 * abs(np.fft.rfft(Waves(sea()).elevation(0.5 * np.arange(7200), 0, 0)) / 7200)**2
        wp = 2 * np.pi / 8
        bounds = wp * np.array([0.5, 0.8125, 0.9375, 1.0625, 1.1875, 1.5, 2, 3])
        first = np.ceil(bounds * 3600 / (2 * np.pi)).astype(int)
        for i in range(7):
            target = methods.JonswapSpectrum(sea()).variance(bounds[i], bounds[i + 1])
            near(energy[first[i]:first[i + 1]].sum(), target, atol=0.05 * target + 0.002)

    def test_waves_obey_the_laws_of_water(self):
        """No divergence, no vorticity; the surface moves with the water, and the acceleration is the derivative of the
        velocity. Euler's equation: the pressure gradient accelerates the water."""
        random, h = np.random.default_rng(1), 1e-4
        for depth_m in (0, 15):
            waves = Waves(sea(water_depth_m=depth_m))
            for _ in range(20):
                p, t = random.uniform([-50, -50, -14], [50, 50, -1]), random.uniform(0, 100)
                gradient = np.column_stack([(waves.at(t, p + e).velocity - waves.at(t, p - e).velocity) / (2 * h)
                                            for e in h * np.eye(3)])
                near(np.trace(gradient), 0, atol=1e-8)
                near(np.linalg.norm(gradient - gradient.T), 0, atol=1e-8)
                rate = (waves.at(t + h, p).velocity - waves.at(t - h, p).velocity) / (2 * h)
                near(np.linalg.norm(rate - waves.at(t, p).acceleration), 0, atol=1e-7)
                x, y, surface = p[0], p[1], waves.at(t, [p[0], p[1], 0])
                rises = np.diff(waves.elevation([t - h, t + h], x, y)) / (2 * h)
                slope = np.diff(waves.elevation(t, [x - h, x + h], y)) / (2 * h)
                near([surface.velocity[2], surface.slope[0]], np.ravel([rises, slope]), atol=1e-7)
                near(-GRAVITY * waves.at(t, p).slope[0], waves.at(t, p).acceleration[0], atol=1e-9)

    def test_waves_decay_with_depth(self):
        waves = Waves(sea(components=1))
        for z in (-1, -10, -30):
            speeds = [np.linalg.norm(waves.at(2, [0, 0, at]).velocity) for at in (z, 0)]
            near(speeds[0] / speeds[1], np.exp(waves.components()[0].wave_number_rad_m * z), atol=1e-12)
        # A sea of 8 s, integrated with NumPy from 0.5 to 3 ω_p, keeps 0.3973 of its speed at 10 m.
        spectra = [methods.acceleration_spectrum(sea(), depth, 0.5, 3, 2000) for depth in (10, 0)]
        deep, surface = (np.sum(np.array(s.density) / np.array(s.omega_rad_s)**2) for s in spectra)
        near(np.sqrt(deep / surface), 0.3973, atol=5e-5)

    def test_dispersion_holds_in_finite_depth(self):
        for depth_m in (0.5, 5, 50, 5000):
            for omega in (0.3, 1, 3):
                k = methods.wave_number(omega, depth_m, GRAVITY)
                near(GRAVITY * k * np.tanh(k * depth_m), omega**2, atol=1e-12 * omega**2)
        # No vertical motion at the bottom.
        near(Waves(sea(water_depth_m=15)).at(1, [0, 0, -15]).velocity[2], 0, atol=1e-14)

    def test_the_slope_is_low_pass_filtered(self):
        """As by a filter over the slope's samples."""
        tau, step, p = 0.32, 1e-3, [3, -2, -5]
        raw, filtered = Waves(sea()), Waves(sea(), tau)
        value = filtered.at(0, p).slope[0]
        for i in range(5000):
            value += -np.expm1(-step / tau) * (raw.at(step * (i + 0.5), p).slope[0] - value)
            if i % 500 == 499:
                near(filtered.at(step * (i + 1), p).slope[0], value, atol=1e-6)

    def test_still_water_and_nonsense(self):
        still = Waves(sea(significant_height_m=0), 0.3)
        self.assertEqual((still.elevation(1, 2, 3), np.linalg.norm(still.at(1, [1, 2, -3]).velocity)), (0, 0))
        for keys in ({"significant_height_m": -1}, {"peak_period_s": 0}, {"gamma": 0.5}, {"components": 0}):
            self.assertRaises(ValueError, Waves, sea(**keys))
        self.assertRaises(ValueError, Waves, sea(), -1)


def acceleration_density(omega, peak_period_s):
    """JONSWAP's formula times ω⁴ exp(−2 ω² d/g), not normalised."""
    peak = 2 * np.pi / peak_period_s
    bump = np.exp(-0.5 * ((omega - peak) / (np.where(omega <= peak, 0.07, 0.09) * peak))**2)
    return np.exp(-1.25 * (peak / omega)**4) * 3.3**bump / omega * np.exp(-2 * omega**2 / GRAVITY * DEPTH_M)


def force_of(peak_period_s, std_N):
    """The spectrum of a force with this standard deviation on the vertical axis."""
    step = 5 * 2 * np.pi / peak_period_s / 400
    omega = step * (np.arange(400) + 0.5)
    density = acceleration_density(omega, peak_period_s)
    return ForceSpectrum(omega_rad_s=omega, density=density * std_N**2 / (density.sum() * step),
                         noise=methods.force_noise_density(VERTICAL, omega))


def density_of(pair, omega):
    return sum(methods.spectral_density(one, omega) for one in pair)


def distance_of(spectrum, density):
    """Itakura's and Saito's."""
    ratio = (np.array(spectrum.density) + spectrum.noise) / (density + np.array(spectrum.noise))
    return np.sum(ratio - np.log(ratio) - 1)


class ResonatorFit(unittest.TestCase):
    def test_the_acceleration_spectrum_is_the_jonswap_spectrum_times_the_decay(self):
        state = sea(heading_rad=0, components=1000)
        s = methods.acceleration_spectrum(state, DEPTH_M, 0.5, 3, 200)
        expected = acceleration_density(np.array(s.omega_rad_s), 8)
        near(np.array(s.density) * expected[100] / s.density[100] / expected, 1, atol=1e-10)
        # Its area is the variance of a realisation with many components: the band holds 99 % of the waves.
        area = sum(s.density) * (s.omega_rad_s[1] - s.omega_rad_s[0])
        a = [c.amplitude_m * c.omega_rad_s**2 * np.exp(-c.wave_number_rad_m * DEPTH_M)
             for c in Waves(state, 0.3).components()]
        near(0.5 * np.sum(np.square(a)) / area, 1, atol=0.02)

    def test_the_density_matches_the_resonator(self):
        """Its area is σ², its shape that of the sampled resonator."""
        r = Resonator(omega_rad_s=0.9, damping=0.1, std=0.2)
        near(methods.spectral_density(r, np.arange(5e-4, 60, 1e-3)).sum() * 1e-3 / r.std**2, 1, atol=1e-4)
        step = methods.resonator_step(r.omega_rad_s, r.damping, 1e-3)
        noise = methods.resonator_noise(r.omega_rad_s, r.damping, r.std, 1e-3)
        for w in (0.5, 0.9, 1.4):
            gain = np.linalg.inv(np.exp(1e-3j * w) * np.eye(2) - step)[0, 1]
            near(methods.spectral_density(r, w) / (abs(gain)**2 * noise * 1e-3 / np.pi), 1, atol=5e-3)

    def test_it_recovers_a_known_pair(self):
        truth = [Resonator(omega_rad_s=0.7, damping=0.05, std=0.1), Resonator(omega_rad_s=1.2, damping=0.15, std=0.15)]
        w = 0.01 * (np.arange(3000) + 0.5)  # covers the whole variance
        found = methods.fit_resonators(ForceSpectrum(omega_rad_s=w, density=density_of(truth, w), noise=np.full(3000, 1e-6)))
        for one, true in zip(found, truth):
            near([one.omega_rad_s / true.omega_rad_s], 1, atol=1e-3)
            near([one.damping / true.damping, one.std / true.std], 1, atol=1e-2)

    def test_it_is_the_best_fit_to_the_force(self):
        """No neighbour is closer, by a separate distance. The best single resonator of a search over frequency and
        damping is not closer either. Before scaling, the pair has 0.90 to 1.05 of the force's variance, so scaling
        hardly changes the fit."""
        random = np.random.default_rng(3)
        for period_s in (4, 6, 8, 10, 14):
            s = force_of(period_s, 0.17)
            w, pair = np.array(s.omega_rad_s), methods.fit_resonators(s)
            self.assertLess(pair[0].omega_rad_s, pair[1].omega_rad_s)
            near(pair[0].std**2 + pair[1].std**2, 0.17**2, atol=1e-9)

            def varied(scale, by=np.ones((2, 3))):
                return distance_of(s, density_of([
                    Resonator(omega_rad_s=one.omega_rad_s * f, damping=one.damping * d, std=scale * one.std * a)
                    for one, (f, d, a) in zip(pair, by)], w))

            scales = np.arange(0.9, 1.05, 1e-4)
            distances = [varied(scale) for scale in scales]
            scale, best = scales[np.argmin(distances)], min(distances)
            self.assertTrue(0.9 < scale < 1.049)
            for _ in range(200):
                self.assertGreater(varied(scale, 1 + random.uniform(-1, 1, (2, 3)) * [0.02, 0.05, 0.02]), best - 1e-4)
            single = min(distance_of(s, methods.spectral_density(Resonator(omega_rad_s=omega, damping=damping, std=0.17), w))
                         for omega in np.arange(0.4, 2, 0.01) for damping in 0.02 * 1.1**np.arange(32))
            self.assertLess(varied(1), 0.9 * single)

    def test_the_random_walk_is_the_best_fit(self):
        s = force_of(8, 0.17)
        w, walk = np.array(s.omega_rad_s), methods.fit_walk(s, PERIOD_S)

        def distance(std_N):
            return distance_of(s, std_N**2 / (np.pi * PERIOD_S * w**2))

        for factor in 0.2 * 1.05**np.arange(66):
            self.assertGreaterEqual(distance(factor * walk), distance(walk) - 1e-9)
        s.density = 4e-6 / (np.pi * PERIOD_S * w**2)
        near(methods.fit_walk(s, PERIOD_S), 2e-3, atol=1e-8)

    def test_the_noise_of_an_axis_is_the_sum_of_its_parts(self):
        """White noise of the position, random walks of the velocity and of the force, as forces."""
        for part, expected in (({"position_std_m": 0.5}, 8.1), ({"velocity_std_m_s": 0.3}, 3.6), ({"bias_std_N": 0.3}, 0.1)):
            none = {"mass_kg": 2, "position_std_m": 0, "velocity_std_m_s": 0, "bias_std_N": 0, "period_s": 0.1}
            near(methods.force_noise_density(AxisNoise(**none | part), 3), expected / np.pi, atol=1e-12)

    def test_it_refuses_nonsense(self):
        good = force_of(8, 0.17)
        rows = {name: np.array(getattr(good, name)) for name in ("omega_rad_s", "density", "noise")}
        again, zero = rows["omega_rad_s"].copy(), rows["noise"].copy()
        again[4], zero[3] = again[3], 0
        for spoilt in ({name: [] for name in rows}, {"noise": zero}, {"density": np.zeros(400)},
                       {"density": rows["density"][1:]}, {"noise": np.append(rows["noise"], 1)}, {"omega_rad_s": again},
                       {name: row[:5] for name, row in rows.items()}):
            self.assertRaises(ValueError, methods.fit_resonators, ForceSpectrum(**rows | spoilt))
        self.assertRaises(ValueError, methods.fit_walk, good, 0)


def feed(bank, pair, strengths, seed):
    """An axis under the force of a resonator pair with a strength in each sample, held in place by a known force.
    Returns a function that gives the bank the samples between two times."""
    random, forces = np.random.default_rng(seed), 0
    for one in pair:
        A = methods.resonator_step(one.omega_rad_s, one.damping, PERIOD_S)
        noise = np.sqrt(methods.resonator_noise(one.omega_rad_s, one.damping, one.std, PERIOD_S))
        forces += lfilter([0, A[0, 1]], [1, -np.trace(A), np.linalg.det(A)],
                          noise * strengths * random.normal(size=len(strengths)))
    gain = PERIOD_S / VERTICAL.mass_kg
    v = lfilter([gain], [1, 1.5 * gain - 1 - 1, 1 - 1.5 * gain + PERIOD_S * gain], np.diff(forces, prepend=0))
    p = lfilter([0, PERIOD_S], [1, -1], v)
    hold = np.append(0, -p - 1.5 * v)[:-1]
    measured = p + VERTICAL.position_std_m * random.normal(size=len(p))
    return lambda start_s, end_s: bank.update(*(x[round(start_s / PERIOD_S):round(end_s / PERIOD_S)] for x in (hold, measured)))


def bank_of(*periods_s):
    shapes = [methods.fit_resonators(force_of(period_s, 0.17)) for period_s in periods_s]
    shapes = [[Resonator(omega_rad_s=one.omega_rad_s, damping=one.damping, std=one.std / 0.17) for one in pair]
              for pair in shapes]
    return WaveForceBankDesign(shapes=shapes, mass_kg=VERTICAL.mass_kg, position_std_m=VERTICAL.position_std_m)


SEA = [Resonator(omega_rad_s=0.81, damping=0.03, std=0.11), Resonator(omega_rad_s=1.13, damping=0.09, std=0.07)]


class Bank(unittest.TestCase):
    def test_it_finds_the_strength(self):
        """60 s of a sea with a period of 8 s have about ten waves. The strength itself varies by a quarter."""
        design = bank_of(8)
        for strength in (0.06, 0.2, 0.6):
            bank = WaveForceBank(design)
            near(methods.total_std(bank.resonators()), np.sqrt(0.03), atol=1e-9)  # no measurement yet
            update = feed(bank, design.shapes[0], np.repeat([strength, 2 * strength], [70000, 30000]), 5)
            update(0, 100)
            ratios = []
            for i in range(10):
                update(100 + 60 * i, 160 + 60 * i)
                ratios.append(methods.total_std(bank.resonators()) / strength)
            near(np.mean(np.log(ratios)), 0, atol=0.2)
            update(700, 1000)
            self.assertGreater(methods.total_std(bank.resonators()), 1.4 * strength)

    def test_it_finds_the_period(self):
        design = bank_of(5, 8, 12)
        for truth in design.shapes:
            bank = WaveForceBank(design)
            feed(bank, truth, np.full(20000, 0.25), 7)(0, 200)
            near(methods.mean_frequency(bank.resonators()) / methods.mean_frequency(truth), 1, atol=0.1)

    def test_it_finds_the_period_of_a_sine(self):
        """Two equal resonators of half the variance are one. The likelihood of a noisy sine over a minute is flat, and its
        mean is up to 17 % too long. The right one of two candidates has all the likelihood."""
        def found(candidates_s, period_s, noise_m):
            halves = [Resonator(omega_rad_s=2 * np.pi / T, damping=0.15, std=np.sqrt(0.5)) for T in candidates_s]
            bank = WaveForceBank(WaveForceBankDesign(
                shapes=[(half, half) for half in halves], mass_kg=1.38, bias_std_N=2e-3, velocity_std_m_s=3e-3,
                weakest_N=0.3, strengths=1))
            noise = np.random.default_rng(3).uniform(-noise_m, noise_m, 12000)
            p = v = 0.0
            for k in range(12000):
                force, hold = 0.3 * np.sin(2 * np.pi / period_s * PERIOD_S * k), -p - 1.5 * v  # a known force against drift
                bank.update(hold, p + noise[k])
                p, v = p + PERIOD_S * v, v + PERIOD_S / 1.38 * (force + hold)
            return 2 * np.pi / methods.mean_frequency(bank.resonators())

        for period_s in (6, 8, 11):
            near(found(methods.candidate_periods(), period_s, 0.17) / period_s, 1, atol=0.2)
        for period_s in (5, 12):
            near(found((5, 12), period_s, 0) / period_s, 1, atol=1e-3)

    def test_it_does_not_depend_on_where_the_axis_starts(self):
        design = WaveForceBankDesign(shapes=[SEA], settling_s=1)
        here, there = WaveForceBank(design), WaveForceBank(design)
        first = methods.total_std(here.resonators())
        there.reset(50)
        p = 1e-3 * np.sin(0.02 * np.arange(500))
        here.update(0, p)
        there.update(0, 50 + p)
        near(methods.total_std(there.resonators()), methods.total_std(here.resonators()), atol=1e-6)
        self.assertNotEqual(methods.total_std(here.resonators()), first)

    def test_it_refuses_nonsense(self):
        self.assertRaises(ValueError, WaveForceBank, WaveForceBankDesign())
        WaveForceBank(WaveForceBankDesign(shapes=[SEA]))
        for positive in "mass_kg bias_std_N velocity_std_m_s position_std_m weakest_N memory_s period_s".split():
            with self.assertRaisesRegex(ValueError, "^wave force bank: every value must be positive$"):
                WaveForceBank(WaveForceBankDesign(shapes=[SEA], **{positive: 0}))
        wrong = WaveForceBankDesign(shapes=[SEA], strongest_N=0.03, weakest_N=0.03)
        self.assertRaises(ValueError, WaveForceBank, wrong)
        wrong.strengths = 1
        WaveForceBank(wrong)


PHYSICAL = methods.QuadrotorModel(methods.QuadrotorParameters())
# The model is linear without thrust, drag and gyroscopic terms.
LINEAR = methods.QuadrotorModel(methods.QuadrotorParameters(
    linear_drag=np.zeros(6), quadratic_drag=np.zeros(6), inertia_kgm2=np.full(3, 0.85)))
MASS = methods.QuadrotorParameters().mass_kg
R = np.diag([1e-2] * 3 + [1e-4] * 3)
P0 = np.diag([1e-2] * 3 + [1e-4] * 3 + [2e-3] * 3 + [4e-4] * 3 + [1e-2] * 6 + [1e-5] * 3 + [1e-2] * 9)


def process_of(model=PHYSICAL, noise=methods.ProcessNoiseStd(), pair=SEA, share=0.5, kinematics="exact"):
    return methods.WaveForces(model, noise, pair, share, PERIOD_S, getattr(methods.AttitudeKinematics, kinematics))


class Process(unittest.TestCase):
    def test_the_rigid_acceleration_matches_the_body(self):
        """Derivatives of ψ̇ = (q sin φ + r cos φ)/cos θ and the other angles, by differences. A rotation moves with
        body rates under torques and drag."""
        random, inertia, step_s = np.random.default_rng(2), methods.QuadrotorParameters().inertia_kgm2, 1e-4
        for _ in range(20):
            angles, omega, U = random.uniform(-1, 1, 3), random.uniform(-1, 1, 3), random.uniform(-2, 2, 4)
            drag = PHYSICAL.drag([0, 0, 0, *omega])[3:]
            turning = (U[1:] - drag - np.cross(omega, inertia * omega)) / inertia

            def rates_after(h):
                turned = Rotation.from_euler("ZYX", angles[::-1]) * Rotation.from_rotvec(h * (omega + h / 2 * turning))
                return methods.attitude_rates(turned.as_euler("ZYX")[::-1], omega + h * turning)

            expected = (rates_after(step_s) - rates_after(-step_s)) / (2 * step_s)
            velocity = [*random.uniform(-1, 1, 3), *methods.attitude_rates(angles, omega)]
            rigid, level = PHYSICAL.accelerations(angles, velocity, U)
            self.assertLess(np.linalg.norm(rigid[3:] - expected), 1e-5)
            np.testing.assert_array_equal(rigid[:3], level[:3])

    def test_it_has_the_forces_variance_and_spectrum(self):
        """The solution of V = Φ V Φᵀ + Q has the variances of the pair, with the sum of the force's spectrum. The spectrum
        of the sampled process has the force's distribution over frequency within 0.12."""
        for period_s in (6, 8, 10):
            s = force_of(period_s, 0.24)
            process = process_of(pair=methods.fit_resonators(s))
            for axis, expected in ((0, 0.24**2 / 2), (2, 0.24**2)):
                rows = np.ix_(*[[12 + axis, 21 + axis, 24 + axis, 27 + axis]] * 2)  # f₁, h₁, f₂, h₂
                phi, Q = process.linear()[rows], process.Q()[rows]
                V = solve_discrete_lyapunov(phi, Q)
                near((V[0, 0] + V[2, 2] + 2 * V[0, 2]) / expected, 1, atol=0.01)
            step = s.omega_rad_s[1] - s.omega_rad_s[0]
            z = np.exp(1j * PERIOD_S * np.array(s.omega_rad_s))[:, None, None] * np.eye(4)
            gains = np.linalg.inv(z - phi)[:, [0, 2]].sum(axis=1)
            density = abs(gains)**2 @ np.diag(Q) * PERIOD_S / np.pi
            self.assertLess(abs(np.cumsum(s.density - density)).max() * step / expected, 0.12)

    def test_it_steps_as_under_constant_acceleration(self):
        """One sample, which is exact at rest for position, velocity and angles."""
        process, x = process_of(LINEAR, share=1), np.random.default_rng(4).uniform(-0.3, 0.3, 30)
        x[3:6] = x[9:12] = 0
        step = process.linear() @ x
        step[:12] += process.nonlinear(x, np.zeros(4))
        a = np.append((x[12:15] + x[15:18] + x[24:27]) / MASS, x[18:21] / 0.85)
        a[2] -= LINEAR.net_weight_N() / MASS
        self.assertLess(np.linalg.norm(step[6:12] - x[6:12] - PERIOD_S * a), 1e-14)
        self.assertLess(np.linalg.norm(step[:6] - x[:6] - PERIOD_S * x[6:12] - 5e-5 * a), 1e-14)

    def test_the_ukf_is_the_kalman_filter_of_a_linear_vehicle(self):
        """The textbook filter: P = A P Aᵀ + Q, K = P Cᵀ (C P Cᵀ + R)⁻¹, Joseph's form."""
        process = process_of(LINEAR, kinematics="level")
        ukf, x, P, A, Q = methods.Ukf(process, R, P0), np.zeros(30), P0, process.linear(), process.Q()
        C, fall = np.eye(6, 30), -LINEAR.net_weight_N() / MASS
        random = np.random.default_rng(6)
        for k in range(1000):
            y = np.sqrt(np.diag(R)) * random.uniform(-1, 1, 6)
            ukf.predict(np.zeros(4))
            ukf.correct(y)
            x = A @ x
            x[[2, 8]] += [PERIOD_S**2 / 2 * fall, PERIOD_S * fall]
            P = A @ P @ A.T + Q
            K = P @ C.T @ np.linalg.inv(C @ P @ C.T + R)
            keep = np.eye(30) - K @ C
            x, P = x + K @ (y - C @ x), keep @ P @ keep.T + K @ R @ K.T
            self.assertLess(abs(ukf.x() - x).max(), 1e-10, k)
            self.assertLess(abs(ukf.P() - P).max(), 1e-10, k)

    def test_the_nees_is_in_its_band_with_a_true_model(self):
        """If the true process is the model, (x − x̂)ᵀ P⁻¹ (x − x̂) of all 30 states is χ² with 30 degrees of freedom."""
        process = process_of(noise=methods.ProcessNoiseStd(velocity_std_m_s=2e-4, rate_std_rad_s=1e-4))
        random, runs, nees, A = np.random.default_rng(9), 60, [], process.linear()
        stds = [np.sqrt(np.diag(covariance)) for covariance in (P0, process.Q(), R)]
        for _ in range(runs):
            ukf, x = methods.Ukf(process, R, P0), stds[0] * random.normal(size=30)
            for _ in range(300):
                T = PHYSICAL.net_weight_N() / 4 + 0.1 * random.normal(size=4)
                g = process.nonlinear(x, T)
                x = A @ x + stds[1] * random.normal(size=30)
                x[:12] += g
                ukf.predict(T)
                ukf.correct(x[:6] + stds[2] * random.normal(size=6))
            nees.append((x - ukf.x()) @ np.linalg.solve(ukf.P(), x - ukf.x()))
        near(np.mean(nees), 30, atol=1.96 * np.sqrt(2 * 30 / runs))

    def test_it_refuses_nonsense(self):
        undamped = [SEA[0], Resonator(omega_rad_s=1.13, damping=1, std=0.07)]
        self.assertRaises(ValueError, process_of, pair=undamped)
        self.assertRaises(ValueError, process_of, share=0)
        self.assertRaises(ValueError, process_of().set_torque_noise, 0)
        design = methods.QuadrotorEstimatorDesign(order=methods.DisturbanceOrder.spectrum)
        self.assertRaises(ValueError, methods.check_estimator, design)  # no sea
        design.waves = WaveForceBankDesign(shapes=[SEA])
        methods.check_estimator(design)
        design.filter = methods.QuadrotorFilter.ekf
        self.assertRaises(ValueError, methods.check_estimator, design)


if __name__ == "__main__":
    unittest.main()
