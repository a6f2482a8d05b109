"""Force control of tests/regression/press.toml."""

import numpy as np

import breakwater as bw

LINK_M = 0.3


class Admittance(bw.Controller):
    """The tip yields to the error of the force along x, as a damper would, and keeps its y. The joints follow."""

    damping_Ns_m = 100.0
    k_p = np.array([300.0, 125.0])
    k_d = np.array([7.0, 3.0])

    @staticmethod
    def tip(q):
        links = LINK_M * np.exp(1j * np.cumsum(q))  # x + iy of each
        to_tip = np.cumsum(links[::-1])[::-1]       # from each joint
        return to_tip[0], np.array([-to_tip.imag, to_tip.real])

    def reset(self, t, y):
        self.q_ref = np.array(y.positions)
        self.last = self.q_ref.copy()
        self.y_m = self.tip(self.q_ref)[0].imag

    def update(self, t, y):
        tip, jacobian = self.tip(self.q_ref)
        toward_wall = (self.setup.force_reference(t) - y.force_N) / self.damping_Ns_m
        dq_ref = np.linalg.solve(jacobian, [toward_wall, 10.0 * (self.y_m - tip.imag)])
        self.q_ref += self.setup.period_s * dq_ref
        dq = (y.positions - self.last) / self.setup.period_s
        self.last = np.array(y.positions)
        return self.k_p * (self.q_ref - y.positions) + self.k_d * (dq_ref - dq)
