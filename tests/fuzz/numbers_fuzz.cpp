// Problems for the solvers, designs and estimators.
//
// - A quadratic program with any H, g, Ω and bounds, solved a few times in sequence. A solution
// that
//   the active-set solver calls solved satisfies the KKT conditions, and no result has a value that
//   is not finite.
// - Riccati equations and pole placement for any matrices. A design that is not refused is finite,
//   and the closed loop of a regulator is stable.
// - Sequences of inputs and measurements for every disturbance estimator of an axis. Every estimate
//   is finite as long as both are below 1e6.
#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include <breakwater/linear/eigenvalues.h>
#include <breakwater/linear/pole_placement.h>
#include <breakwater/linear/qp.h>
#include <breakwater/linear/riccati.h>
#include <breakwater/linear/state_space.h>
#include <breakwater/observers/eso.h>
#include <breakwater/observers/fakfd.h>
#include <breakwater/observers/gsf.h>
#include <breakwater/observers/idob.h>
#include <breakwater/observers/immkf.h>
#include <breakwater/observers/kfd.h>
#include <breakwater/observers/mckf.h>
#include <breakwater/observers/multiple_model_estimator.h>
#include <breakwater/observers/stf.h>
#include <breakwater/observers/vbakf.h>
#include <breakwater/observers/vfakfd.h>
#include "fuzz/input.h"

namespace breakwater {
namespace {

constexpr int kMostVariables = 4;
constexpr int kMostRows = 6;

void solve(fuzz::Input& input, QpSolverKind kind, const QpModel& model) {
  const auto solver = make_qp_solver(kind, model, 200);
  const Eigen::Index n = model.H.rows();
  const Eigen::Index m = model.Omega.rows();
  QpSolution solution(n, m);
  Eigen::VectorXd gradient(n);
  for (int repeat = 0; repeat < 3; ++repeat) {
    QpInput problem(n, m);
    problem.g = input.vector(n);
    for (Eigen::Index i = 0; i < m; ++i) {
      const int bounds = input.whole(3);
      if (bounds != 0) problem.lower(i) = input.number();
      if (bounds != 1) problem.upper(i) = bounds == 3 ? problem.lower(i) : input.number();
      if (input.whole(7) == 0) problem.softness(i) = std::abs(input.number());
    }
    solver->solve(problem, solution);
    fuzz::require(solution.z.allFinite(), "z is finite");
    fuzz::require(solution.mu.allFinite(), "the multipliers are finite");
    if (kind != QpSolverKind::active_set || solution.status != QpStatus::solved) continue;
    const double largest = solution.z.lpNorm<Eigen::Infinity>();
    // Products overflow.
    if (std::max(largest, solution.mu.lpNorm<Eigen::Infinity>()) > 1e140) continue;
    const Eigen::VectorXd values = model.Omega * solution.z;
    // Other sums of Ω z and H z differ from those of the solver.
    const Eigen::VectorXd root = model.H.diagonal().cwiseSqrt();
    const double reach = solution.z.cwiseProduct(root).lpNorm<Eigen::Infinity>();
    const double slope = problem.g.cwiseQuotient(root).lpNorm<Eigen::Infinity>();
    const double rounding = 1e-12 * (1.0 + reach / bound_scale(model, problem) + reach / slope);
    fuzz::require(kkt_residual(model, problem, solution, values, gradient) <=
                      1.01 * kQpSolvedBelow + rounding,
                  "solved means optimal");
  }
}

void read_program(const std::string& text) {
  fuzz::Input input(text);
  const auto kind = input.whole(1) == 0 ? QpSolverKind::hildreth : QpSolverKind::active_set;
  const int n = 1 + input.whole(kMostVariables - 1);
  const int m = input.whole(kMostRows);
  QpModel model;
  model.H = input.weight(n);
  model.Omega = input.matrix(m, n);
  solve(input, kind, model);
}

void regulator(fuzz::Input& input, int n, int m) {
  const Eigen::MatrixXd A = input.matrix(n, n);
  const Eigen::MatrixXd B = input.matrix(n, m);
  const Eigen::MatrixXd Q = input.weight(n);
  const LqrDesign design = dlqr(A, B, Q, input.weight(m));
  fuzz::require(design.K.allFinite() && design.P.allFinite(), "the regulator is finite");
  fuzz::require(is_positive_semidefinite(design.P), "P is positive semidefinite");
  fuzz::require(spectral_radius(A - B * design.K) < 1.0 + 1e-6, "the regulator stabilises");
}

void observer(fuzz::Input& input, int n, int p) {
  const Eigen::MatrixXd A = input.matrix(n, n);
  const Eigen::MatrixXd C = input.matrix(p, n);
  std::vector<PoleGroup> groups(static_cast<std::size_t>(p));
  for (int i = 0; i < n; ++i) {
    const double real = input.number();
    const double imaginary = input.whole(2) == 0 ? input.number() : 0.0;
    PoleGroup& group = groups[static_cast<std::size_t>(i % p)];
    group.emplace_back(real, imaginary);
    if (imaginary != 0.0) group.emplace_back(real, -imaginary);
  }
  if (input.whole(1) == 0) groups = sample_poles(groups, 0.01);
  fuzz::require(place_observer_poles(A, C, groups).allFinite(), "the observer's gain is finite");
}

void hold(fuzz::Input& input, int n, int m) {
  const StateSpace plant{input.matrix(n, n), input.matrix(n, m), input.matrix(1, n)};
  const StateSpace sampled = zero_order_hold(plant, input.number());
  fuzz::require(sampled.A.allFinite() && sampled.B.allFinite(), "the sampled plant is finite");
}

void read_design(const std::string& text) {
  fuzz::Input input(text);
  const int design = input.whole(2);
  const int n = 1 + input.whole(3);
  const int m = 1 + input.whole(1);
  if (design == 0) regulator(input, n, m);
  if (design == 1) observer(input, n, std::min(m, n));
  if (design == 2) hold(input, n, m);
}

// A positive number, mostly near 1.
double positive(fuzz::Input& input) {
  const double value = std::abs(input.number());
  return value > 0.0 ? value : 1.0;
}

std::unique_ptr<DisturbanceEstimator> estimator(fuzz::Input& input) {
  const int kind = input.whole(9);
  const double period_s = 0.01 * positive(input);
  StateSpace plant;
  plant.A = Eigen::Matrix2d{{0.0, 1.0}, {0.0, -input.number()}};
  plant.B = Eigen::Vector2d(0.0, positive(input));
  plant.C = Eigen::RowVector2d(1.0, 0.0);
  const SensorError error{
      Eigen::VectorXd::Constant(1, std::abs(input.number()) * 1e-3),
      Eigen::VectorXd::Constant(1, std::abs(input.number()) * 1e-3),
      input.whole(1) == 0 ? EncoderRounding::nearest : EncoderRounding::truncate};
  if (kind == 0) {
    return std::make_unique<Idob>(plant, std::vector<PoleGroup>{{-10.0, -11.0, -12.0}}, period_s);
  }
  if (kind == 1) {
    return std::make_unique<Eso>(plant, EsoDesign{positive(input) * 10.0}, period_s);
  }
  if (kind == 2) return sized_multiple_model({plant, period_s, error, positive(input)});
  KalmanDesign design;
  design.plant = sample_with_disturbance_model(plant, input.whole(2), period_s);
  const Eigen::Index n = design.plant.states();
  design.Q = disturbance_noise(design.plant, positive(input));
  design.R = Eigen::MatrixXd::Constant(1, 1, positive(input) * 1e-4);
  design.P0 = positive(input) * Eigen::MatrixXd::Identity(n, n);
  switch (kind) {
    case 3:
      return std::make_unique<Kfd>(design);
    case 4:
      return std::make_unique<Fakfd>(design,
                                     Eigen::VectorXd::Constant(n, 1.0 + std::abs(input.number())));
    case 5:
      return std::make_unique<Vfakfd>(design, VfakfdDesign{});
    case 6:
      return std::make_unique<Stf>(design, error);
    case 7:
      return sized_immkf(design, error, {});
    case 8:
      return sized_mckf(design, error, {});
    default:
      return input.whole(1) == 0 ? sized_gsf(design, error, 3) : sized_vbakf(design, {});
  }
}

void read_measurements(const std::string& text) {
  constexpr int kMostSamples = 200;
  fuzz::Input input(text);
  const auto filter = estimator(input);
  filter->reset(Eigen::VectorXd::Zero(2));
  bool are_finite = true;
  for (int k = 0; k < kMostSamples && !input.is_empty(); ++k) {
    const Eigen::VectorXd u = input.vector(1);
    const Eigen::VectorXd y = input.vector(1);
    filter->update(u, y);
    // Larger values may overflow.
    are_finite = are_finite && std::abs(u(0)) < 1e6 && std::abs(y(0)) < 1e6;
    if (!are_finite) continue;
    fuzz::require(filter->state().allFinite(), "the state is finite");
    fuzz::require(filter->disturbance().allFinite(), "the disturbance is finite");
  }
}

constexpr fuzz::Parser kParsers[] = {
    {'q', "qp", read_program}, {'d', "design", read_design}, {'e', "estimator", read_measurements}};

}  // namespace
}  // namespace breakwater

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return breakwater::fuzz::run_selected(breakwater::kParsers, data, size);
}
