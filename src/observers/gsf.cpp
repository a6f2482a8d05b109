#include <breakwater/observers/gsf.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>

#include <breakwater/math/functions.h>
#include <breakwater/math/refuse_unless.h>

namespace breakwater {
namespace {

// The nodes of Gauss and Legendre in [−1, 1]; the weights add up to 1.
constexpr std::size_t kNodes = 5;
constexpr std::array<double, kNodes> kNode = {-0.906179845938664, -0.5384693101056831, 0.0,
                                              0.5384693101056831, 0.906179845938664};
constexpr std::array<double, kNodes> kWeight = {0.11846344252809454, 0.23931433524968324,
                                                0.28444444444444444, 0.23931433524968324,
                                                0.11846344252809454};
constexpr double kSmallestShare = 1e-6;
constexpr double kSmallestDeterminant = 1e-300;

template <typename Covariance>
double log_determinant(const Covariance& P) {
  return math::log(std::max(P.determinant(), kSmallestDeterminant));
}

template <int N>
class Gsf final : public GuardedKalman<N> {
 public:
  Gsf(const KalmanDesign& design, const SensorError& sensor, int parts)
      : GuardedKalman<N>(design), sensor_(sensor) {
    refuse_unless(parts >= 1 && parts <= 20, "GSF: the number of parts must be from 1 to 20");
    most_parts_ = static_cast<std::size_t>(parts);
    parts_.reserve(most_parts_ * kNodes);
    products_.reserve(most_parts_ * kNodes);
    costs_.setZero(static_cast<long>(products_.capacity()),
                   static_cast<long>(products_.capacity()));
  }

 private:
  using typename GuardedKalman<N>::Vector;
  using typename GuardedKalman<N>::State;
  using typename GuardedKalman<N>::Covariance;

  struct Part {
    State x;
    Covariance P;
    double weight;
    double log_determinant;  // ln |P|
    State gain;              // K of the last correction
  };

  void step(const Vector& held_input, const Vector& y) override {
    const bool begins = this->has_prior_;
    if (begins) {
      parts_.clear();
      parts_.push_back({this->extended_state_, this->covariance_, 1.0, 0.0, State::Zero()});
    }
    double innovation = 0.0;
    for (Part& part : parts_) {
      this->extended_state_ = part.x;
      this->covariance_ = part.P;
      this->has_prior_ = begins;
      this->predict_sample(held_input, y);
      innovation += part.weight * this->innovation_(0);
      part.x = this->extended_state_;
      part.P = this->covariance_;
    }
    if (this->is_measured_) {
      multiply(sensor_.observe(y(0)));
      reduce();
    }
    const auto weight = [this](long i) { return parts_[static_cast<std::size_t>(i)].weight; };
    mix(parts_, weight, this->extended_state_, this->covariance_);
    this->innovation_(0) = innovation;
  }

  // Replaces each part by its products with the nodes' densities.
  void multiply(const CodeSensor::Observation& observed) {
    sensor_.add_noise(this->instant_error_(0));
    const double length = observed.range.width();
    const std::size_t nodes = length > 0.0 ? kNodes : 1;
    products_.clear();
    double best = -INFINITY;
    for (const Part& part : parts_) {
      for (std::size_t j = 0; j < nodes; ++j) {
        const double share = kWeight[j] * length;
        const double R = sensor_.noise_variance() + share * share / 12.0;
        const double z = observed.y + observed.range.middle() + 0.5 * length * kNode[j];
        const double S = part.P(0, 0) + R;
        const double e = z - part.x(0);
        Part product = part;
        product.gain = part.P.col(0) / S;
        correct_along(product.x, product.P, 0, S, e, 1.0);
        product.weight =
            math::log(part.weight) + log_density(e, S) + (nodes == 1 ? 0.0 : math::log(kWeight[j]));
        best = std::max(best, product.weight);
        products_.push_back(product);
      }
    }
    for (Part& product : products_) product.weight = math::exp(product.weight - best);
    parts_.clear();
    for (Part& product : products_) {
      if (!(product.weight > kSmallestShare)) continue;
      product.log_determinant = log_determinant(product.P);
      parts_.push_back(product);
    }
    // Also if no weight is a number: the guard then starts the filter again.
    if (parts_.empty()) parts_.push_back(products_.front());
    double sum = 0.0;
    for (const Part& part : parts_) sum += part.weight;
    this->gain_.setZero();
    for (Part& part : parts_) {
      part.weight /= sum;
      this->gain_ += part.weight * part.gain;
    }
  }

  static Part join(const Part& a, const Part& b) {
    Part joined = a;
    joined.weight = a.weight + b.weight;
    const double share = b.weight / joined.weight;
    const State offset = b.x - a.x;
    joined.x = a.x + share * offset;
    joined.P = a.P + share * (b.P - a.P) + share * (1.0 - share) * offset * offset.transpose();
    joined.log_determinant = log_determinant(joined.P);
    return joined;
  }

  // An upper bound of the Kullback–Leibler distance between the sums before and after the union.
  double cost(std::size_t i, std::size_t j) const {
    const Part &a = parts_[i], &b = parts_[j];
    const Part joined = join(a, b);
    return joined.weight * joined.log_determinant - a.weight * a.log_determinant -
           b.weight * b.log_determinant;
  }

  void reduce() {
    if (parts_.size() <= most_parts_) return;
    const auto at = [this](std::size_t i, std::size_t j) -> double& {
      return costs_(static_cast<long>(std::min(i, j)), static_cast<long>(std::max(i, j)));
    };
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) at(i, j) = cost(i, j);
    }
    while (parts_.size() > most_parts_) {
      std::size_t first = 0, second = 1;
      for (std::size_t i = 0; i < parts_.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
          if (at(i, j) < at(first, second)) first = j, second = i;
        }
      }
      parts_[first] = join(parts_[first], parts_[second]);
      const std::size_t last = parts_.size() - 1;
      parts_[second] = parts_[last];
      for (std::size_t i = 0; i < last; ++i) {
        if (i != second) at(i, second) = at(i, last);
      }
      parts_.pop_back();
      for (std::size_t i = 0; i < last; ++i) {
        if (i != first) at(i, first) = cost(i, first);
      }
    }
  }

  CodeSensor sensor_;
  std::size_t most_parts_;
  std::vector<Part> parts_;
  std::vector<Part> products_;
  Eigen::MatrixXd costs_;
};

}  // namespace

std::unique_ptr<KalmanEstimator> sized_gsf(const KalmanDesign& design, const SensorError& sensor,
                                           int parts) {
  return of_axis_size<Gsf>(design, sensor, parts);
}

}  // namespace breakwater
