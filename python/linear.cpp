#include "module.h"

#include <pybind11/complex.h>
#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <array>
#include <filesystem>
#include <string>
#include <tuple>
#include <utility>

#include <breakwater/linear/pole_placement.h>
#include <breakwater/linear/qp.h>
#include <breakwater/linear/riccati.h>
#include <breakwater/linear/state_space.h>
#include <breakwater/observers/disturbance_model.h>
#include <breakwater/plants/damped_inertia.h>
#include <breakwater/plants/planar_chain.h>
#include <breakwater/shell/paths.h>
#include "interpreter.h"

namespace breakwater::python {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

auto matrices(StateSpace plant) {
  return std::tuple(std::move(plant.A), std::move(plant.B), std::move(plant.C));
}

auto solve(QpSolver& solver, const Vector& g, const Vector& lower, const Vector& upper,
           const Vector& softness) {
  constexpr std::array kStatus = {"solved", "iteration_cap", "infeasible", "not_finite",
                                  "inaccurate"};
  QpInput input(g.size(), lower.size());
  input.g = g;
  input.lower = lower;
  input.upper = upper;
  input.softness = softness;
  QpSolution solution(g.size(), lower.size());
  solver.solve(input, solution);
  return std::tuple(solution.z, solution.mu, kStatus.at(static_cast<std::size_t>(solution.status)),
                    solution.iterations, solution.kkt_residual);
}

// A file as in a key of a scenario: from the working folder, or one of Breakwater's.
PlanarChain load_chain(const std::string& file) {
  const auto found = find_file(file, std::filesystem::current_path());
  return load_planar_chain(found ? found->string() : file);
}

}  // namespace

void bind_linear(py::module_& module) {
  module.def(
      "dare",
      [](const Matrix& A, const Matrix& B, const Matrix& Q, const Matrix& R) {
        LqrDesign design = dlqr(A, B, Q, R);
        return std::pair(std::move(design.K), std::move(design.P));
      },
      Apart());
  module.def("place_observer_poles", place_observer_poles, Apart());
  module.def(
      "zero_order_hold",
      [](const Matrix& A, const Matrix& B, const Matrix& C, double period_s) {
        return matrices(zero_order_hold({A, B, C}, period_s));
      },
      Apart());
  module.def(
      "extend_by_disturbance_model",
      [](const Matrix& A, const Matrix& B, const Matrix& C, int order, double period_s) {
        return matrices(extend_by_disturbance_model({A, B, C}, order, period_s).sampled);
      },
      Apart());
  module.def(
      "damped_inertia",
      [](double inertia, double viscous_friction) {
        return matrices(damped_inertia(inertia, viscous_friction));
      },
      OwnCall());
  module.def(
      "observability_rank",
      [](const Matrix& A, const Matrix& C) {
        check(StateSpace{A, Matrix::Zero(A.rows(), 1), C});
        return observability_rank(A, C);
      },
      Apart());

  py::class_<QpSolver>(module, "Qp")
      .def(py::init([](const Matrix& H, const Matrix& Omega, bool is_exact, int max_iterations) {
             const Unlocked unlocked;
             return make_qp_solver(is_exact ? QpSolverKind::active_set : QpSolverKind::hildreth,
                                   {H, Omega}, max_iterations);
           }),
           OwnCall())
      .def("solve", solve, OwnCall())
      .def("reset", &QpSolver::reset, OwnCall());

  py::class_<PlanarChain>(module, "PlanarChain")
      .def(py::init(&load_chain), OwnCall())
      .def("tip_pose", &PlanarChain::tip_pose, OwnCall())
      .def(
          "tip_jacobian",
          [](const PlanarChain& chain, const Vector& q_rad) {
            TaskJacobian J(chain.held(), chain.joints());
            chain.tip_jacobian(q_rad, J);
            return Matrix(J);
          },
          OwnCall())
      .def("mass_matrix", &PlanarChain::mass_matrix, OwnCall())
      .def_property_readonly("joints", &PlanarChain::joints)
      .def_property_readonly("effort_limits_Nm", &PlanarChain::effort_limits_Nm,
                             py::return_value_policy::copy);
}

}  // namespace breakwater::python
