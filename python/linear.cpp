#include "module.h"

#include <pybind11/complex.h>
#include <pybind11/stl.h>

#include <filesystem>
#include <limits>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <vector>

#include <breakwater/linear/pole_placement.h>
#include <breakwater/linear/qp.h>
#include <breakwater/linear/riccati.h>
#include <breakwater/linear/state_space.h>
#include <breakwater/observers/disturbance_model.h>
#include <breakwater/plants/damped_inertia.h>
#include <breakwater/plants/planar_chain.h>
#include <breakwater/shell/paths.h>
#include "arrays.h"
#include "interpreter.h"

namespace breakwater::python {
namespace {

py::tuple matrices(const StateSpace& plant) {
  return py::make_tuple(matrix_array(plant.A), matrix_array(plant.B), matrix_array(plant.C));
}

py::tuple dare(const py::object& A, const py::object& B, const py::object& Q, const py::object& R) {
  const LqrDesign design = apart([A = matrix(A, "A"), B = matrix(B, "B"), Q = matrix(Q, "Q"),
                                  R = matrix(R, "R")] { return dlqr(A, B, Q, R); });
  return py::make_tuple(matrix_array(design.K), matrix_array(design.P));
}

py::array_t<double> place_for_observer(const py::object& A, const py::object& C,
                                       const std::vector<PoleGroup>& poles) {
  return matrix_array(apart([A = matrix(A, "A"), C = matrix(C, "C"), poles] {
    return place_observer_poles(A, C, poles);
  }));
}

py::array_t<double> place_for_control(const py::object& A, const py::object& B,
                                      const std::vector<PoleGroup>& poles) {
  // eig(A − B K) = eig(Aᵀ − Kᵀ Bᵀ).
  return matrix_array(apart([A = matrix(A, "A"), B = matrix(B, "B"), poles]() -> Eigen::MatrixXd {
    return place_observer_poles(A.transpose(), B.transpose(), poles).transpose();
  }));
}

py::tuple hold(const py::object& A, const py::object& B, const py::object& C, double period_s) {
  return matrices(apart([plant = StateSpace{matrix(A, "A"), matrix(B, "B"), matrix(C, "C")},
                         period_s] { return zero_order_hold(plant, period_s); }));
}

py::tuple extend(const py::object& A, const py::object& B, const py::object& C,
                 const py::object& order, double period_s) {
  const int whole = whole_number(order, "order");
  return matrices(
      extend_by_disturbance_model({matrix(A, "A"), matrix(B, "B"), matrix(C, "C")}, whole, period_s)
          .sampled);
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
  Qp(const py::object& H, const py::object& Omega, const py::object& solver,
     const py::object& max_iterations) {
    solver_ = apart([kind = one_of<QpSolverKind>(solver, "solver",
                                                 {{"active_set", QpSolverKind::active_set},
                                                  {"hildreth", QpSolverKind::hildreth}}),
                     model = QpModel{matrix(H, "H"), matrix(Omega, "Omega")},
                     most = whole_number(max_iterations, "max_iterations")] {
      return make_qp_solver(kind, model, most);
    });
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
    {
      const std::lock_guard lock(turn_);
      const Unlocked unlocked;
      solver_->solve(input, solution);
    }
    return py::make_tuple(array(Eigen::Ref<const Eigen::VectorXd>(solution.z)),
                          array(Eigen::Ref<const Eigen::VectorXd>(solution.mu)),
                          text(solution.status), solution.iterations, solution.kkt_residual);
  }

  void reset() {
    const std::lock_guard lock(turn_);
    solver_->reset();
  }

 private:
  std::unique_ptr<QpSolver> solver_;
  Turn turn_;
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
PlanarChain load_chain(const py::object& urdf) {
  const std::string file = utf8(urdf, "urdf");
  const auto found = find_file(file, std::filesystem::current_path());
  return load_planar_chain(found ? found->string() : file);
}

void bind_chain(py::module_& module) {
  auto bound = bind_class<PlanarChain>(
      module, "PlanarChain",
      "A planar serial manipulator from a URDF file: kinematics, masses and limits.\n\n"
      "Its tip is the frame of the one link without children.");
  bind_method(
      bound, "tip_pose", "q_rad",
      [](const PlanarChain& chain, const py::object& q) {
        const TipPose pose = chain.tip_pose(angles(chain, q, "q_rad"));
        return array(Eigen::Ref<const Eigen::VectorXd>(pose));
      },
      "The tip's x, y and angle [m, m, rad] at the joint angles (n) [rad].", py::arg("q_rad"));
  bind_method(
      bound, "tip_jacobian", "q_rad",
      [](const PlanarChain& chain, const py::object& q) {
        TipJacobian J(3, chain.joints());
        chain.tip_jacobian(angles(chain, q, "q_rad"), J);
        return matrix_array(J);
      },
      "The derivative of the pose with respect to the angles, (3, n).", py::arg("q_rad"));
  bind_method(
      bound, "mass_matrix", "q_rad",
      [](const PlanarChain& chain, const py::object& q) {
        return matrix_array(chain.mass_matrix(angles(chain, q, "q_rad")));
      },
      "(n, n) [kg m^2], without the motors' armature.", py::arg("q_rad"));
  bound.def(py::init(&load_chain), OwnCall(), py::arg("urdf"))
      .def(py::init([](const py::args&, const py::kwargs&) -> std::unique_ptr<PlanarChain> {
        throw py::type_error("PlanarChain() takes urdf");
      }))
      .def_property_readonly("joints", &PlanarChain::joints, "The number n of joints.")
      .def_property_readonly(
          "effort_limits_Nm",
          [](const PlanarChain& chain) {
            return array(Eigen::Ref<const Eigen::VectorXd>(chain.effort_limits_Nm()));
          },
          "The torque limits of the joints (n) [N m].");
}

}  // namespace

void bind_linear(py::module_& module) {
  module.def("dare", dare, OwnCall());
  module.def("place_observer_poles", place_for_observer, OwnCall());
  module.def("place_poles", place_for_control, OwnCall());
  module.def("zero_order_hold", hold, OwnCall());
  module.def("extend_by_disturbance_model", extend, OwnCall());
  module.def(
      "damped_inertia",
      [](double inertia, double viscous_friction) {
        return matrices(damped_inertia(inertia, viscous_friction));
      },
      OwnCall());
  module.def(
      "observability_rank",
      [](const py::object& A_object, const py::object& C_object) {
        return apart([A = matrix(A_object, "A"), C = matrix(C_object, "C")] {
          check(StateSpace{A, Eigen::MatrixXd::Zero(A.rows(), 1), C});
          return observability_rank(A, C);
        });
      },
      OwnCall());
  bind_class<Qp>(module, "Qp")
      .def(py::init<const py::object&, const py::object&, const py::object&, const py::object&>(),
           OwnCall())
      .def("solve", &Qp::solve, OwnCall())
      .def("reset", &Qp::reset, OwnCall());
  bind_chain(module);
}

}  // namespace breakwater::python
