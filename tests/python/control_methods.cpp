// Predictive control, for tests in Python.
#include "methods.h"

#include <breakwater/control/contact_mpc.h>
#include <breakwater/control/predictive_control.h>
#include <breakwater/control/state_feedback.h>
#include <breakwater/observers/idob.h>
#include <breakwater/plants/damped_inertia.h>

namespace breakwater::python_methods {
std::shared_ptr<DisturbanceEstimator> idob(double period_s) {
  return std::make_shared<Idob>(damped_inertia(1.0, 0.5),
                                std::vector<PoleGroup>{{-20.0, -25.0, -30.0}}, period_s);
}

void bind_predictive_control(py::module_& module) {
  py::register_exception<ControlFailure>(module, "ControlFailure");
  choice<QpSolverKind>(module, "QpSolverKind hildreth active_set");
  choice<QpStatus>(module, "QpStatus solved iteration_cap infeasible not_finite inaccurate");
  choice<OnInfeasible>(module, "OnInfeasible soften stop");
  using L = PredictedBound;
  record(module, "PredictedBound component lower upper steps", &L::component, &L::lower, &L::upper,
         &L::steps);
  using D = LmpcDesign;
  const auto own = []<typename Field>(Field Horizon::*field) -> Field D::* { return field; };
  record(module,
         "LmpcDesign A B prediction_steps control_steps Q Q_last R S change_bounds input_bounds "
         "state_bounds solver max_iterations on_infeasible softness",
         own(&D::A), own(&D::B), own(&D::prediction_steps), own(&D::control_steps), own(&D::Q),
         own(&D::Q_last), own(&D::R), own(&D::S), &D::change_bounds, &D::input_bounds,
         &D::state_bounds, &D::solver, &D::max_iterations, &D::on_infeasible, &D::softness);
  using S = QpStatistics;
  record(module, "QpStatistics optimisations unsolved softened capped iterations most_iterations",
         &S::optimisations, &S::unsolved, &S::softened, &S::capped, &S::iterations,
         &S::most_iterations);
  py::class_<QpSolution>(module, "QpSolution")
      .def_readonly("z", &QpSolution::z)
      .def_readonly("mu", &QpSolution::mu)
      .def_readonly("status", &QpSolution::status);
  py::class_<Lmpc>(module, "Lmpc")
      .def(py::init<const D&>())
      .def("optimise",
           [](Lmpc& lmpc, const Eigen::VectorXd& x, const Eigen::VectorXd& last_input,
              const Eigen::VectorXd& reference, const Eigen::VectorXd& reserved) {
             lmpc.u() = last_input;
             lmpc.reference() = reference;
             lmpc.reserved() = reserved;
             return lmpc.optimise(x);
           })
      .def("solution", &Lmpc::solution, py::return_value_policy::copy)
      .def("statistics", &Lmpc::statistics, py::return_value_policy::copy)
      .def("iterations", &Lmpc::iterations)
      .def("softened_bounds", &Lmpc::softened_bounds)
      .def("program", [](const Lmpc& lmpc) {
        const QpInput& input = lmpc.qp_input();
        return std::tuple(lmpc.qp_model().H, Eigen::MatrixXd(lmpc.qp_model().Omega), input.g,
                          input.lower, input.upper, input.softness);
      });
  module.def("predict",
             [](const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, int predicted, int controlled) {
               const Prediction prediction = predict(A, B, predicted, controlled);
               return std::tuple(prediction.Psi, prediction.Gamma, prediction.Theta);
             });
  using C = ContactMpcDesign;
  record(module, "ContactMpcDesign prediction_steps q_velocity r acceleration_m_s2",
         &C::prediction_steps, &C::q_velocity, &C::r, &C::acceleration_m_s2);
  module.def("contact_problem", contact_problem);
  choice<DisturbanceUse>(module, "DisturbanceUse none predict cancel cancel_within_bounds");
  choice<CancelAt>(module, "CancelAt sample decision");
  record(module, "Reference value", &Reference::value);
  using A = AxisLoopDesign;
  record(module, "AxisLoopDesign reference force_limit", &A::reference, &A::force_limit);
  using P = PredictiveControlDesign;
  record(module, "PredictiveControlDesign lmpc disturbance_use cancel_at samples_per_move loop",
         &P::lmpc, &P::disturbance_use, &P::cancel_at, &P::samples_per_move, &P::loop);
  py::class_<Controller>(module, "Controller")
      .def("reset",
           [](Controller& law, const Eigen::VectorXd& y) {
             law.reset({0.0, y});
           })
      .def("update",
           [](Controller& law, double time_s, const Eigen::VectorXd& y, Eigen::VectorXd u) {
             law.update({time_s, y}, u);
             return u;
           })
      .def("signals", [](const Controller& law) {
        std::vector<std::pair<std::string, std::vector<double>>> all;
        for (const Signal& one : law.signals()) {
          all.emplace_back(one.name, std::vector(one.values.begin(), one.values.end()));
        }
        return all;
      });
  const auto disturbance = [](const auto& law) { return law.estimator().disturbance(); };
  py::class_<PredictiveControl, Controller>(module, "PredictiveControl")
      .def(py::init([](const P& design, double period_s) {
        return std::make_unique<PredictiveControl>(idob(period_s), design);
      }))
      .def("disturbance", [disturbance](const PredictiveControl& law) { return disturbance(law); });
  py::class_<LqrControl, Controller>(module, "LqrControl")
      .def(py::init([](double period_s, const Eigen::RowVectorXd& K, bool uses_true_state,
                       double force_limit) {
        return std::make_unique<LqrControl>(
            idob(period_s), AxisLoopDesign{.force_limit = force_limit}, K, uses_true_state);
      }))
      .def("disturbance", [disturbance](const LqrControl& law) { return disturbance(law); });
}

}  // namespace breakwater::python_methods
