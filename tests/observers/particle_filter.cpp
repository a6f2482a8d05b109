#include "particle_filter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace {

constexpr double kWidest = 256.0;     // kernels, if no particle explains a measurement
constexpr double kJumpsDrawn = 0.02;  // share of the particles that jump at each sample, at least
constexpr double kShareOfAges =
    0.02;  // share of the particles, for all that jumped at about the same time

// std::normal_distribution has other draws in each library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : bits_(seed) {}

  double uniform() { return (static_cast<double>(bits_() >> 11) + 0.5) * 0x1p-53; }
  double normal() {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    double a = 0.0, b = 0.0, s = 0.0;
    do {
      a = 2.0 * uniform() - 1.0;
      b = 2.0 * uniform() - 1.0;
      s = a * a + b * b;
    } while (s >= 1.0 || s == 0.0);
    const double scale = std::sqrt(-2.0 * std::log(s) / s);
    has_spare_ = true;
    spare_ = scale * b;
    return scale * a;
  }
  /// N(0, 1) within [a, b], by rejection.
  double normal_within(double a, double b) {
    if (b < -a) return -normal_within(-b, -a);
    if (b - a < 1.5) {
      const double nearest = std::max(a, 0.0);
      for (;;) {
        const double x = a + (b - a) * uniform();
        if (uniform() < std::exp(0.5 * (nearest * nearest - x * x))) return x;
      }
    }
    if (a < 0.5) {
      for (;;) {
        const double x = normal();
        if (x >= a && x <= b) return x;
      }
    }
    const double rate = 0.5 * (a + std::sqrt(a * a + 4.0));
    for (;;) {
      const double x = a - std::log(uniform()) / rate;
      if (x <= b && uniform() < std::exp(-0.5 * (x - rate) * (x - rate))) return x;
    }
  }

 private:
  std::mt19937_64 bits_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

// Probability that N(0, 1) is in [a, b]. It does not underflow to a difference of ones.
double mass(double a, double b) {
  if (a < 0.0 && b < 0.0) return mass(-b, -a);
  const auto above = [](double x) { return 0.5 * std::erfc(x / std::numbers::sqrt2); };
  return above(a) - above(b);
}

struct Interval {
  double lower, upper;

  double length() const { return upper - lower; }
  bool has(double x) const { return x >= lower && x <= upper; }
  Interval moved(double by) const { return {lower + by, upper + by}; }
  Interval and_in(const Interval& other) const {
    return {std::max(lower, other.lower), std::min(upper, other.upper)};
  }
};

// The particles that jumped at about the same time.
template <std::size_t N>
struct Kernel {
  using State = std::array<double, N>;
  double weight = 0.0, squares = 0.0;
  State mean{};
  std::array<State, N> L{};  // lower triangle: L Lᵀ is the kernel's covariance
  double shrink = 1.0;
};

template <std::size_t N>
class ParticleFilter {
  using State = std::array<double, N>;
  using Kernel = ::Kernel<N>;

 public:
  ParticleFilter(const GeneratedMotion& motion, int particles, std::uint64_t seed)
      : motion_(motion),
        random_(seed),
        x_(static_cast<std::size_t>(particles)),
        next_(x_.size()),
        weights_(x_.size(), 1.0),
        trial_(x_.size()),
        travel_(x_.size()),
        jumped_(x_.size(), 0),
        next_jumped_(x_.size()) {}

  void start(const Interval& measured, double noise_std) {
    for (State& x : x_) {
      for (std::size_t i = 1; i < N; ++i) x[i] = motion_.initial_std[i] * random_.normal();
      x[0] = noise_std > 0.0 ? measured.lower + noise_std * random_.normal()
                             : measured.lower + measured.length() * random_.uniform();
    }
  }

  /// From sample k − 1 to k. Returns whether any particle explains the measurement.
  bool step(double u, const Interval& last, const Interval& measured, double noise_std, int k) {
    predict(u, k);
    if (correct(measured, noise_std)) {
      x_.swap(next_);
      jumped_.swap(next_jumped_);
      weights_.swap(trial_);
      return true;
    }
    bool is_explained = false;
    for (double wider = 1.0; wider <= kWidest && !is_explained; wider *= 4.0) {
      is_explained = resample(u, last, measured, noise_std, k - 1, wider);
    }
    predict(u, k);
    x_.swap(next_);
    jumped_.swap(next_jumped_);
    weights_.swap(trial_);
    if (is_explained) return true;
    for (State& x : x_) x[0] = std::clamp(x[0], measured.lower, measured.upper);
    return false;
  }

  double mean(const double* row) const {
    double sum = 0.0, total = 0.0;
    for (std::size_t i = 0; i < x_.size(); ++i) {
      sum += weights_[i] * dot(row, x_[i]);
      total += weights_[i];
    }
    return sum / total;
  }

 private:
  double dot(const double* row, const State& x) const {
    double value = 0.0;
    for (std::size_t j = 0; j < N; ++j) value += row[j] * x[j];
    return value;
  }

  void predict(double u, int k) {
    const auto walking = static_cast<std::size_t>(motion_.walking);
    const auto jumping = static_cast<std::size_t>(motion_.jumping);
    for (std::size_t p = 0; p < x_.size(); ++p) {
      for (std::size_t i = 0; i < N; ++i) {
        next_[p][i] = dot(motion_.A + i * N, x_[p]) + motion_.B[i] * u;
      }
      if (motion_.walking >= 0) next_[p][walking] += motion_.walk_std * random_.normal();
    }
    next_jumped_ = jumped_;
    trial_ = weights_;
    if (motion_.jumping < 0) return;
    // More particles jump, with smaller weights. The gaps between them are geometric.
    const double p = motion_.jump_probability, drawn = std::max(p, kJumpsDrawn);
    const double weight = p / drawn * (1.0 - drawn) / (1.0 - p);
    const double scale = 1.0 / std::log1p(-drawn);
    const auto gap = [&] {
      return std::min(1e12, std::floor(std::log(random_.uniform()) * scale));
    };
    for (double at = gap(); at < static_cast<double>(x_.size()); at += 1.0 + gap()) {
      const auto i = static_cast<std::size_t>(at);
      // Half of the sizes have twice the standard deviation: large jumps are rare, but matter.
      const double size = (random_.uniform() < 0.5 ? 1.0 : 2.0) * random_.normal();
      next_[i][jumping] = motion_.jump_std * size;
      next_jumped_[i] = k;
      trial_[i] *= weight / (0.5 + 0.25 * std::exp(0.375 * size * size));
    }
  }

  // Returns whether enough particles remain.
  bool correct(const Interval& measured, double noise_std) {
    double sum = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < x_.size(); ++i) {
      const double q = next_[i][0];
      const double e = (q - measured.lower) / noise_std;
      trial_[i] *= noise_std > 0.0 ? std::exp(-0.5 * e * e) : measured.has(q);
      sum += trial_[i];
      squares += trial_[i] * trial_[i];
    }
    const auto count = static_cast<double>(x_.size());
    if (sum * sum <= 0.5 * squares * count) return false;
    for (double& weight : trial_) weight *= count / sum;
    return true;
  }

  // The kernels are over [w; q; …]: the way w = q(k + 1) − q(k) replaces the velocity. Neither the
  // noise nor a jump at k + 1 has an effect on w.
  State to_kernel(const State& x, double u) const {
    State t = x;
    t[0] = dot(motion_.A, x) + motion_.B[0] * u - x[0];
    t[1] = x[0];
    return t;
  }
  State from_kernel(const State& t, double u) const {
    State x = t;
    x[0] = t[1];
    x[1] = 0.0;
    x[1] = (t[0] + x[0] - dot(motion_.A, x) - motion_.B[0] * u) / motion_.A[1];
    return x;
  }

  static std::size_t age(int k, int jumped) {
    return static_cast<std::size_t>(std::ilogb(static_cast<double>(k - jumped) + 1.0));
  }

  using Kernels = std::array<Kernel, 32>;
  Kernels kernels(double u, int k, double wider) const {
    Kernels all;
    for (std::size_t i = 0; i < x_.size(); ++i) {
      Kernel& kernel = all[age(k, jumped_[i])];
      kernel.weight += weights_[i];
      kernel.squares += weights_[i] * weights_[i];
      const State t = to_kernel(x_[i], u);
      for (std::size_t j = 0; j < N; ++j) kernel.mean[j] += weights_[i] * t[j];
    }
    for (Kernel& kernel : all) {
      for (std::size_t j = 0; j < N && kernel.weight > 0.0; ++j) kernel.mean[j] /= kernel.weight;
    }
    for (std::size_t i = 0; i < x_.size(); ++i) {
      Kernel& kernel = all[age(k, jumped_[i])];
      const State t = to_kernel(x_[i], u);
      for (std::size_t r = 0; r < N; ++r) {
        for (std::size_t c = 0; c <= r; ++c) {
          kernel.L[r][c] += weights_[i] * (t[r] - kernel.mean[r]) * (t[c] - kernel.mean[c]);
        }
      }
    }
    for (Kernel& kernel : all) {
      if (kernel.weight > 0.0) finish(kernel, wider);
    }
    return all;
  }

  // Shrinks the covariance by the bandwidth, and takes its Cholesky factor.
  void finish(Kernel& kernel, double wider) const {
    const double count = kernel.weight * kernel.weight / kernel.squares;
    const double h = count < N + 2.0 ? 0.0 : std::pow(4.0 / ((N + 2.0) * count), 1.0 / (N + 4.0));
    kernel.shrink = std::sqrt(1.0 - std::min(1.0, h * h));
    State variance{};
    for (std::size_t r = 0; r < N; ++r) {
      for (std::size_t c = 0; c <= r; ++c) kernel.L[r][c] *= h * h * wider * wider / kernel.weight;
      variance[r] = kernel.L[r][r];
    }
    for (std::size_t c = 0; c < N; ++c) {
      double pivot = kernel.L[c][c];
      for (std::size_t j = 0; j < c; ++j) pivot -= kernel.L[c][j] * kernel.L[c][j];
      // A state that all particles share has no kernel.
      const double root = pivot > 1e-12 * variance[c] ? std::sqrt(pivot) : 0.0;
      for (std::size_t r = c; r < N; ++r) {
        double value = kernel.L[r][c];
        for (std::size_t j = 0; j < c; ++j) value -= kernel.L[r][j] * kernel.L[c][j];
        kernel.L[r][c] = root > 0.0 ? value / root : 0.0;
      }
    }
  }

  double centre(const Kernel& kernel, const State& t, std::size_t j) const {
    return kernel.mean[j] + kernel.shrink * (t[j] - kernel.mean[j]);
  }

  // Particles of sample k, given the measurements of k and k + 1. The way w is drawn first. Then
  // the position is limited by both codes, and its mass is the weight.
  bool resample(double u, const Interval& last, const Interval& measured, double noise_std, int k,
                double wider) {
    const Kernels all = kernels(u, k, wider);
    double best = -HUGE_VAL, sum = 0.0;
    for (std::size_t i = 0; i < x_.size(); ++i) {
      const Kernel& kernel = all[age(k, jumped_[i])];
      const State t = to_kernel(x_[i], u);
      travel_[i] = random_.normal();
      const double w = centre(kernel, t, 0) + kernel.L[0][0] * travel_[i];
      const double q = centre(kernel, t, 1) + kernel.L[1][0] * travel_[i], s = kernel.L[1][1];
      const Interval both = measured.moved(-w).and_in(last);
      if (weights_[i] == 0.0) {
        trial_[i] = -HUGE_VAL;
      } else if (noise_std > 0.0) {
        const double S = s * s + noise_std * noise_std, e = measured.lower - w - q;
        trial_[i] = std::log(weights_[i]) - 0.5 * (e * e / S + std::log(S));
      } else if (both.length() <= 0.0) {
        trial_[i] = -HUGE_VAL;
      } else if (s > 0.0) {
        trial_[i] = std::log(weights_[i] * mass((both.lower - q) / s, (both.upper - q) / s));
      } else {
        trial_[i] = both.has(q) ? std::log(weights_[i]) : -HUGE_VAL;
      }
      best = std::max(best, trial_[i]);
    }
    if (!std::isfinite(best)) return false;
    for (double& value : trial_) {
      value = std::exp(value - best);
      sum += value;
    }

    // Each age keeps some particles, so that a jump that shows later is not forgotten.
    std::array<std::vector<std::size_t>, 32> members;
    std::array<double, 32> masses{};
    for (std::size_t i = 0; i < x_.size(); ++i) {
      if (trial_[i] == 0.0) continue;
      members[age(k, jumped_[i])].push_back(i);
      masses[age(k, jumped_[i])] += trial_[i];
    }
    const auto count = static_cast<double>(x_.size());
    const auto ages = std::count_if(masses.begin(), masses.end(), [](double m) { return m > 0.0; });
    const double free = 1.0 - kShareOfAges * static_cast<double>(ages);
    std::size_t p = 0;
    double until = 0.0;
    for (std::size_t a = 0; a < members.size(); ++a) {
      if (members[a].empty()) continue;
      const std::size_t first = p;
      until += count * (kShareOfAges + free * masses[a] / sum);
      const auto size = static_cast<std::size_t>(std::lround(until)) - first;
      const double step = masses[a] / static_cast<double>(size), offset = random_.uniform();
      std::size_t m = 0;
      double reached = trial_[members[a][0]];
      for (; p < first + size; ++p) {
        while (reached < (static_cast<double>(p - first) + offset) * step &&
               m + 1 < members[a].size()) {
          reached += trial_[members[a][++m]];
        }
        const std::size_t i = members[a][m];
        next_[p] = draw(all[a], i, u, last, measured, noise_std);
        next_jumped_[p] = jumped_[i];
        weights_[p] = step * count / sum;
      }
    }
    x_.swap(next_);
    jumped_.swap(next_jumped_);
    return true;
  }

  State draw(const Kernel& kernel, std::size_t i, double u, const Interval& last,
             const Interval& measured, double noise_std) {
    const State t = to_kernel(x_[i], u);
    State normal{};
    normal[0] = travel_[i];
    for (std::size_t j = 2; j < N; ++j) normal[j] = random_.normal();
    const double w = centre(kernel, t, 0) + kernel.L[0][0] * normal[0];
    const double q = centre(kernel, t, 1) + kernel.L[1][0] * normal[0], s = kernel.L[1][1];
    if (noise_std > 0.0) {
      const double S = s * s + noise_std * noise_std;
      normal[1] = s * (measured.lower - w - q) / S + noise_std / std::sqrt(S) * random_.normal();
    } else if (s > 0.0) {
      const Interval both = measured.moved(-w).and_in(last);
      normal[1] = random_.normal_within((both.lower - q) / s, (both.upper - q) / s);
    }
    State drawn{};
    for (std::size_t r = 0; r < N; ++r) {
      drawn[r] = centre(kernel, t, r);
      for (std::size_t c = 0; c <= r; ++c) drawn[r] += kernel.L[r][c] * normal[c];
    }
    return from_kernel(drawn, u);
  }

  const GeneratedMotion& motion_;
  Random random_;
  std::vector<State> x_, next_;
  std::vector<double> weights_, trial_, travel_;
  std::vector<int> jumped_, next_jumped_;  // sample of the last jump
};

template <std::size_t N>
int run(const GeneratedMotion& motion, int samples, const double* u, const double* lower,
        const double* upper, double noise_std, int particles, std::uint64_t seed, double* v,
        double* d) {
  ParticleFilter<N> filter(motion, particles, seed);
  const auto measured = [&](int k) { return Interval{lower[k], upper[k]}; };
  filter.start(measured(0), noise_std);
  const std::array<double, N> velocity{0.0, 1.0};
  int lost = 0;
  for (int k = 0; k < samples; ++k) {
    if (k > 0) {
      lost += filter.step(u[k - 1], measured(k - 1), measured(k), noise_std, k) ? 0 : 1;
    }
    v[k] = filter.mean(velocity.data());
    d[k] = filter.mean(motion.D);
  }
  return lost;
}

}  // namespace

int breakwater_particle_filter(const GeneratedMotion* motion, int samples, const double* u,
                               const double* lower, const double* upper, double noise_std,
                               int particles, std::uint64_t seed, double* v, double* d) {
  const auto run_all = motion->states == 3 ? run<3> : motion->states == 4 ? run<4> : run<5>;
  return run_all(*motion, samples, u, lower, upper, noise_std, particles, seed, v, d);
}
