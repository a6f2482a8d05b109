#include "linear.h"

#include <pybind11/complex.h>
#include <pybind11/stl.h>

#include <filesystem>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <breakwater/linear/observability.h>
#include <breakwater/linear/pole_placement.h>
#include <breakwater/linear/qp.h>
#include <breakwater/linear/riccati.h>
#include <breakwater/linear/state_space.h>
#include <breakwater/observers/disturbance_model.h>
#include <breakwater/plants/damped_inertia.h>
#include <breakwater/plants/planar_chain.h>
#include <breakwater/shell/paths.h>
#include "arrays.h"

namespace breakwater::python {
namespace {

py::tuple matrices(const StateSpace& plant) {
  return py::make_tuple(matrix_array(plant.A), matrix_array(plant.B), matrix_array(plant.C));
}

py::tuple dare(const py::object& A, const py::object& B, const py::object& Q, const py::object& R) {
  const LqrDesign design = dlqr(matrix(A, "A"), matrix(B, "B"), matrix(Q, "Q"), matrix(R, "R"));
  return py::make_tuple(matrix_array(design.K), matrix_array(design.P));
}

py::array_t<double> place_for_observer(const py::object& A, const py::object& C,
                                       const std::vector<PoleGroup>& poles) {
  return matrix_array(place_observer_poles(matrix(A, "A"), matrix(C, "C"), poles));
}

py::array_t<double> place_for_control(const py::object& A, const py::object& B,
                                      const std::vector<PoleGroup>& poles) {
  // eig(A − B K) = eig(Aᵀ − Kᵀ Bᵀ).
  const Eigen::MatrixXd transposed =
      place_observer_poles(matrix(A, "A").transpose(), matrix(B, "B").transpose(), poles);
  return matrix_array(transposed.transpose());
}

py::tuple hold(const py::object& A, const py::object& B, const py::object& C, double period_s) {
  return matrices(zero_order_hold({matrix(A, "A"), matrix(B, "B"), matrix(C, "C")}, period_s));
}

py::tuple extend(const py::object& A, const py::object& B, const py::object& C, int order,
                 double period_s) {
  return matrices(
      extend_by_disturbance_model({matrix(A, "A"), matrix(B, "B"), matrix(C, "C")}, order, period_s)
          .sampled);
}

QpSolverKind solver_kind(const std::string& name) {
  if (name == "active_set") return QpSolverKind::active_set;
  if (name == "hildreth") return QpSolverKind::hildreth;
  throw std::invalid_argument("solver: must be active_set or hildreth, is \"" + name + "\"");
}

const char* text(QpStatus status) {
  switch (status) {
    case QpStatus::solved:
      return "solved";
    case QpStatus::iteration_cap:
      return "iteration_cap";
    case QpStatus::infeasible:
      return "infeasible";
    case QpStatus::not_finite:
      return "not_finite";
    case QpStatus::inaccurate:
      return "inaccurate";
  }
  throw std::logic_error("unknown status");
}

// −∞ and +∞ mean no bound. NaN is refused.
Eigen::VectorXd bounds(const py::object& object, Eigen::Index size, double otherwise,
                       const std::string& name) {
  if (object.is_none()) return Eigen::VectorXd::Constant(size, otherwise);
  const py::array_t<double> values = numbers(object, name);
  if (values.ndim() != 1 || values.size() != size) {
    throw std::invalid_argument(name + ": must be " + std::to_string(size) + " numbers, is " +
                                description(object));
  }
  Eigen::VectorXd copy = Eigen::Map<const Eigen::VectorXd>(values.data(), size);
  if (copy.hasNaN()) throw std::invalid_argument(name + ": must not be nan");
  return copy;
}

class Qp {
 public:
  Qp(const py::object& H, const py::object& Omega, const std::string& solver, int max_iterations) {
    const QpModel model{matrix(H, "H"), matrix(Omega, "Omega")};
    solver_ = make_qp_solver(solver_kind(solver), model, max_iterations);
  }

  py::tuple solve(const py::object& g, const py::object& lower, const py::object& upper,
                  const py::object& softness) {
    const Eigen::Index n = solver_->model().H.rows();
    const Eigen::Index m = solver_->model().Omega.rows();
    QpInput input(n, m);
    input.g = vector_of(g, n, "g");
    input.lower = bounds(lower, m, -kNoBound, "lower");
    input.upper = bounds(upper, m, kNoBound, "upper");
    if (!softness.is_none()) input.softness = vector_of(softness, m, "softness");
    if (m > 0 && input.softness.minCoeff() < 0.0) {
      throw std::invalid_argument("softness: must not be negative");
    }
    QpSolution solution(n, m);
    solver_->solve(input, solution);
    return py::make_tuple(array(Eigen::Ref<const Eigen::VectorXd>(solution.z)),
                          array(Eigen::Ref<const Eigen::VectorXd>(solution.mu)),
                          text(solution.status), solution.iterations, solution.kkt_residual);
  }

  void reset() { solver_->reset(); }

 private:
  std::unique_ptr<QpSolver> solver_;
};

// One angle per joint.
Eigen::VectorXd angles(const PlanarChain& chain, const py::object& q, const char* name) {
  Eigen::VectorXd values = vector(q, name);
  if (values.size() != chain.joints()) {
    throw std::invalid_argument(std::string(name) + ": must be " + std::to_string(chain.joints()) +
                                " angles, is " + description(q));
  }
  return values;
}

// A file as in a key of a scenario: from the working folder, or one of Breakwater's.
PlanarChain load_chain(const std::string& urdf) {
  const auto found = find_file(urdf, std::filesystem::current_path());
  return load_planar_chain(found ? found->string() : urdf);
}

void bind_chain(py::module_& module) {
  py::class_<PlanarChain>(
      module, "PlanarChain",
      "A planar serial manipulator from a URDF file: kinematics, masses and limits.\n\n"
      "Its tip is the frame of the one link without children.")
      .def(py::init(&load_chain), py::arg("urdf"))
      .def_property_readonly("joints", &PlanarChain::joints, "The number n of joints.")
      .def_property_readonly(
          "effort_limits_Nm",
          [](const PlanarChain& chain) {
            return array(Eigen::Ref<const Eigen::VectorXd>(chain.effort_limits_Nm()));
          },
          "The torque limits of the joints (n) [N m].")
      .def(
          "tip_pose",
          [](const PlanarChain& chain, const py::object& q) {
            const TipPose pose = chain.tip_pose(angles(chain, q, "q_rad"));
            return array(Eigen::Ref<const Eigen::VectorXd>(pose));
          },
          py::arg("q_rad"), "The tip's x, y and angle [m, m, rad] at the joint angles (n) [rad].")
      .def(
          "tip_jacobian",
          [](const PlanarChain& chain, const py::object& q) {
            TipJacobian J(3, chain.joints());
            chain.tip_jacobian(angles(chain, q, "q_rad"), J);
            return matrix_array(J);
          },
          py::arg("q_rad"), "The derivative of the pose with respect to the angles, (3, n).")
      .def(
          "mass_matrix",
          [](const PlanarChain& chain, const py::object& q) {
            return matrix_array(chain.mass_matrix(angles(chain, q, "q_rad")));
          },
          py::arg("q_rad"), "(n, n) [kg m^2], without the motors' armature.");
}

}  // namespace

void bind_linear(py::module_& module) {
  module.def("dare", dare);
  module.def("place_observer_poles", place_for_observer);
  module.def("place_poles", place_for_control);
  module.def("zero_order_hold", hold);
  module.def("extend_by_disturbance_model", extend);
  module.def("damped_inertia", [](double inertia, double viscous_friction) {
    return matrices(damped_inertia(inertia, viscous_friction));
  });
  module.def("observability_rank", [](const py::object& A_object, const py::object& C_object) {
    const Eigen::MatrixXd A = matrix(A_object, "A");
    const Eigen::MatrixXd C = matrix(C_object, "C");
    check(StateSpace{A, Eigen::MatrixXd::Zero(A.rows(), 1), C});
    return observability_rank(A, C);
  });
  py::class_<Qp>(module, "Qp")
      .def(py::init<const py::object&, const py::object&, const std::string&, int>())
      .def("solve", &Qp::solve)
      .def("reset", &Qp::reset);
  bind_chain(module);
}

}  // namespace breakwater::python
