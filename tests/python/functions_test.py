"""The elementary functions of math/: accuracy, special arguments and bits."""

import ctypes
import unittest

import mpmath
import numpy as np

import methods
from support import hash_of, near

TINY, HUGE, INF, NAN = 5e-324, np.finfo(float).max, np.inf, np.nan
LIBM = ctypes.CDLL("libm.so.6")
NAMES = "sin cos tan asin acos exp expm1 log tanh erfc".split()


@np.vectorize
def extended(number):
    """A number of mpmath as a long double."""
    return np.longdouble(float(number)) + np.longdouble(float(number - float(number)))


def exact_erfc(x):
    with mpmath.workdps(25):
        return extended([mpmath.erfc(one) for one in x])


def errors_ulp(values, truths):
    """In units in the last place of the true double."""
    rounded = abs(truths.astype(float))
    return np.where(values == truths.astype(float), 0, abs(values - truths) / (np.nextafter(rounded, INF) - rounded))


def arguments(first, last):
    """Half are spread evenly, half evenly in the logarithm. They have both signs if the range does."""
    random = np.random.default_rng(1)
    even = first + random.uniform(size=20000) * (last - first) if last < HUGE else random.uniform(size=20000) * last
    return np.concatenate([even, np.where(even < 0, first, last) * 2.0**-random.uniform(0, 60, 20000)])


class Functions(unittest.TestCase):
    def test_they_are_within_units_in_the_last_place(self):
        for name, first, last, limit in (
            ("sin", -100, 100, 1), ("cos", -100, 100, 1), ("tan", -100, 100, 1), ("sin", -1e18, 1e18, 1),
            ("cos", -1e18, 1e18, 1), ("tan", -1e18, 1e18, 1), ("asin", -1, 1, 1), ("acos", -1, 1, 1), ("exp", -745, 709, 1),
            ("expm1", -40, 709, 1), ("log", TINY, 4, 1), ("log", TINY, HUGE, 1), ("tanh", -20, 20, 2.5), ("erfc", -6, 26, 4)):
            x = arguments(first, last)
            exact = exact_erfc if name == "erfc" else getattr(np, name.replace("asin", "arcsin").replace("acos", "arccos"))
            self.assertLess(errors_ulp(getattr(methods, name)(x), exact(x.astype(np.longdouble))).max(), limit, name)

    def test_with_two_arguments_they_are_within_units_in_the_last_place(self):
        random = np.random.default_rng(1)
        y, x, base = *random.uniform(-10, 10, (2, 40000)), 2.0**random.uniform(-40, 40, 40000)
        truth = np.arctan2(y.astype(np.longdouble), x.astype(np.longdouble))
        self.assertLess(errors_ulp(methods.atan2(y, x), truth).max(), 1.5)
        truth = np.power(base.astype(np.longdouble), x.astype(np.longdouble))
        self.assertLess(errors_ulp(methods.pow(base, x), truth).max(), 1)

    def test_sine_and_cosine_together_equal_the_separate_functions(self):
        for x in (arguments(-100, 100), arguments(0, HUGE)):
            both = methods.sincos(x)
            np.testing.assert_array_equal([both.imag, both.real], [methods.sin(x), methods.cos(x)])

    def test_special_arguments_follow_the_standard(self):
        """Annex F of C99, which glibc follows."""
        special = [0.0, -0.0, 1.0, -1.0, INF, -INF, NAN, TINY, -TINY]

        def assert_same(name, *x):
            function = getattr(LIBM, name)
            function.restype, function.argtypes = ctypes.c_double, [ctypes.c_double] * len(x)
            ours, theirs = getattr(methods, name)(*x), function(*x)
            if len(x) == 2 or not np.isfinite(theirs) or abs(theirs) in (0, 1):
                self.assertEqual((str(ours), np.signbit(ours) or ours != ours),
                                 (str(theirs), np.signbit(theirs) or theirs != theirs), (name, x))

        for x in special:
            for name in NAMES:
                assert_same(name, x)
            for y in special:
                assert_same("atan2", y, x)
                assert_same("pow", y, x)
        self.assertEqual((methods.exp(710), methods.exp(-746)), (INF, 0))
        self.assertTrue(np.isnan(methods.asin(1.0000000000000002)))
        np.testing.assert_array_equal(methods.pow(2, np.arange(61.0)), np.ldexp(1.0, np.arange(61)))

    def test_complex_exponential_and_logarithm(self):
        z = methods.complex_exp(-0.3 + 2j)
        near(abs(z - np.exp(-0.3) * complex(np.cos(2), np.sin(2))), 0, atol=2e-16)
        back = methods.complex_log(z)
        near(back.real, -0.3, atol=2e-16)
        near(back.imag, 2, atol=5e-16)
        self.assertEqual(methods.complex_exp(complex(1, -0.0)).imag, 0)  # a real pole stays real
        self.assertEqual(methods.complex_log(complex(-1, 0)).imag, np.pi)

    def test_bits_are_the_same_everywhere(self):
        """On every x86-64 processor with every release of musl. Otherwise the goldens of the scenarios change. Exact
        operations on integers make the arguments equal everywhere."""
        for name, first, last, golden in (
            ("sin", -64, 64, 0x1e37738c432aaeb4), ("cos", -64, 64, 0x07236f18aaeb9457), ("sin", 0, 1e9, 0xcefe9a6d39ad3daf),
            ("tan", -2, 2, 0xb8d82913ebfb2fa8), ("asin", -1, 1, 0x84913713dde45500), ("acos", -1, 1, 0xb7afd55bcab09bef),
            ("atan2", -4, 4, 0x6faa59c483afdd93), ("exp", -32, 32, 0xf892fee62bb4d7fb), ("expm1", -2, 2, 0x1bfeebbbf271d38d),
            ("log", 0, 16, 0xdb57a104ede782de), ("pow", 0.25, 16, 0x657dadc605fecdbc), ("tanh", -4, 4, 0x9b8693921705070b)):
            x, second = first + (last - first) * (np.arange(100001) / 131072), {"atan2": [0.75], "pow": [-4.7]}.get(name, [])
            self.assertEqual(hash_of(getattr(methods, name)(x, *second)), golden, name)

    def test_mills_ratio_matches_the_normal_tail(self):
        x = np.concatenate([np.arange(0, 8, 1 / 128), np.arange(8, 100, 0.25)])
        with mpmath.workdps(25):
            truth = extended([mpmath.erfc(z / mpmath.sqrt(2)) * mpmath.exp(z * z / 2) * mpmath.sqrt(mpmath.pi / 2)
                              for z in map(mpmath.mpf, x)])
        near(methods.mills_ratio(x) / truth.astype(float), 1, atol=2e-15)

    def test_mills_ratio_follows_its_bounds_where_the_tail_underflows(self):
        """1/x − 1/x³ < (1 − Φ)/φ < 1/x, where erfc underflows."""
        for x in (1e3, 1e6, 1e150, 1e300):
            self.assertTrue((1 - 1e-15) * (1 - 1 / x / x) / x <= methods.mills_ratio(x) <= (1 + 1e-15) / x)
        self.assertEqual(methods.mills_ratio(INF), 0)


if __name__ == "__main__":
    unittest.main()
