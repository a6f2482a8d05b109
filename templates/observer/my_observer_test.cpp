// Tests the observer alone, with results in closed form.
#include "my_observer.h"

#include <Eigen/LU>
#include <cmath>
#include <cstdio>

#include <breakwater/plants/damped_inertia.h>

namespace {

int failures = 0;

void expect_near(const char* what, double value, double expected, double tolerance) {
  if (std::abs(value - expected) <= tolerance) return;
  std::printf("%s is %.12g, and not %.12g\n", what, value, expected);
  ++failures;
}

// (z − β)³ = z³ − 3β z² + 3β² z − β³.
void all_poles_are_where_they_are_put() {
  const double bandwidth = 60.0;
  const double period_s = 1e-3;
  const my_observer_lab::MyObserver observer(breakwater::damped_inertia(1.0, 0.0), bandwidth,
                                             period_s);
  Eigen::MatrixXd F(3, 3);
  observer.pole_matrix(F);
  const double beta = std::exp(-bandwidth * period_s);
  const double trace = F.trace();
  expect_near("the trace", trace, 3.0 * beta, 1e-9);
  expect_near("the second invariant", 0.5 * (trace * trace - (F * F).trace()), 3.0 * beta * beta,
              1e-9);
  expect_near("the determinant", F.determinant(), beta * beta * beta, 1e-9);
  // The gain for a double integrator is known (Miklosovic, Radke, Gao 2006). d is opposite to u.
  expect_near("l1", observer.L()(0), 1.0 - beta * beta * beta, 1e-9);
  expect_near("l3", observer.L()(2), -std::pow((1.0 - beta) / period_s, 3) * period_s, 1e-6);
}

// The axis moves by Newton's law under a constant disturbance.
void a_constant_disturbance_is_found() {
  const double inertia = 2.0;
  const double period_s = 1e-3;
  const double disturbance = 3.0;
  my_observer_lab::MyObserver observer(breakwater::damped_inertia(inertia, 0.0), 60.0, period_s);
  const Eigen::Vector2d start(0.1, 0.0);
  observer.reset(start);
  const Eigen::VectorXd input = Eigen::VectorXd::Constant(1, 1.0);
  const double acceleration = (input(0) - disturbance) / inertia;
  const int samples = 1000;
  for (int k = 0; k <= samples; ++k) {
    const double t = k * period_s;
    observer.update(input, Eigen::VectorXd::Constant(1, 0.1 + 0.5 * acceleration * t * t));
  }
  expect_near("the velocity", observer.state()(1), acceleration * samples * period_s, 1e-6);
  expect_near("the disturbance", observer.disturbance()(0), disturbance, 1e-4);
}

}  // namespace

int main() {
  all_poles_are_where_they_are_put();
  a_constant_disturbance_is_found();
  return failures == 0 ? 0 : 1;
}
