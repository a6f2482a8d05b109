// Methods that `bw` does not show, for tests in Python: build/tests/methods.so.
#include <pybind11/complex.h>
#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <random>
#include <sstream>

#include <breakwater/control/contact_mpc.h>
#include <breakwater/control/predictive_control.h>
#include <breakwater/control/quadrotor_estimator.h>
#include <breakwater/control/quadrotor_filters.h>
#include <breakwater/control/state_feedback.h>
#include <breakwater/identification/axis_intervals.h>
#include <breakwater/identification/identified_axis.h>
#include <breakwater/identification/identified_study.h>
#include <breakwater/identification/two_inertia_axis.h>
#include <breakwater/math/error_function.h>
#include <breakwater/math/functions.h>
#include <breakwater/observers/idob.h>
#include <breakwater/observers/resonator.h>
#include <breakwater/observers/wave_force_bank.h>
#include <breakwater/plants/damped_inertia.h>
#include <breakwater/statistics/paired_comparison.h>
#include <breakwater/statistics/quantile.h>
#include <breakwater/statistics/ranking.h>
#include <breakwater/statistics/sensitivity.h>
#include <breakwater/statistics/signed_rank.h>
#include <breakwater/study/comparison_table.h>
#include <breakwater/study/ranking_text.h>
#include <breakwater/study/sampling.h>
#include <breakwater/world/waves.h>
#include "identification/bench.h"

namespace breakwater::python_methods {
namespace py = pybind11;

// A struct and its fields. `names` begin with its own. Python makes one from fields by name.
template <typename Record, typename... Fields>
void record(py::module_& module, const char* names, Fields Record::*... fields) {
  std::istringstream words(names);
  std::string name;
  words >> name;
  py::class_<Record> made(module, name.c_str());
  ((words >> name, made.def_readwrite(name.c_str(), fields)), ...);
  made.def(py::init([](const py::kwargs& values) {
    const py::object filled = py::cast(Record{});
    for (const auto& [field, value] : values) py::setattr(filled, field, value);
    return filled.cast<Record>();
  }));
}

// An enumeration, whose name is the first of `names`.
template <typename Choice>
void choice(py::module_& module, const char* names) {
  std::istringstream words(names);
  std::string name;
  words >> name;
  py::enum_<Choice> made(module, name.c_str());
  for (int i = 0; words >> name; ++i) made.value(name.c_str(), Choice(i));
}

Eigen::MatrixXd points(SamplingMethod method, std::uint64_t n, Eigen::Index d, std::uint64_t seed,
                       const std::optional<std::vector<std::uint64_t>>& which) {
  const auto sampler = make_sampler(method, n, d, seed);
  const std::size_t count = which ? which->size() : sampler->size();
  Eigen::MatrixXd all(count, d);
  for (std::size_t i = 0; i < count; ++i) all.row(i) = sampler->point(which ? (*which)[i] : i);
  return all;
}

void bind_statistics(py::module_& module) {
  choice<Goal>(module, "Goal none min max");
  choice<SamplingMethod>(module, "SamplingMethod random latin_hypercube sobol saltelli");
  choice<ComparisonVerdict>(
      module, "ComparisonVerdict better worse smaller larger no_difference_shown too_few_blocks");
  choice<DistributionKind>(module, "DistributionKind uniform log_uniform normal");
  record(module, "ConfidenceInterval lower upper", &ConfidenceInterval::lower,
         &ConfidenceInterval::upper);
  record(module, "EstimatedValue value interval", &EstimatedValue::value,
         &EstimatedValue::interval);
  using R = PairedResults;
  record(module, "PairedResults candidates baseline metrics goals values failed samples runs",
         &R::candidates, &R::baseline, &R::metrics, &R::goals, &R::values, &R::failed, &R::samples,
         &R::runs);
  using C = MetricComparison;
  record(module,
         "MetricComparison pairs blocks median reference_median difference p least_p_holm "
         "probability_smaller probability_better verdict",
         &C::pairs, &C::blocks, &C::median, &C::reference_median, &C::difference, &C::p,
         &C::least_p_holm, &C::probability_smaller, &C::probability_better, &C::verdict);
  using F = FailureComparison;
  record(module,
         "FailureComparison candidate pairs failures reference_failures alone reference_alone p "
         "verdict",
         &F::candidate, &F::pairs, &F::failures, &F::reference_failures, &F::alone,
         &F::reference_alone, &F::p, &F::verdict);
  using A = CandidateComparison;
  record(module, "CandidateComparison metrics failures reached never", &A::metrics, &A::failures,
         &A::reached, &A::never);
  record(module, "Bound metric min max", &Bound::metric, &Bound::min, &Bound::max);
  using I = SensitivityIndices;
  record(module, "SensitivityIndices first_order total rows dropped_rows", &I::first_order,
         &I::total, &I::rows, &I::dropped_rows);
  module.def("compare_candidates", [](const R& results) { return compare_candidates(results); });
  module.def("comparison_text", comparison_text);
  module.def("comparison_csv",
             [](const CandidateComparison& all) { return csv_table(comparison_rows(all)); });
  module.def("ranking_text", [](const R& results, const char* metric, Goal goal,
                                const std::vector<Bound>& bounds, std::size_t width) {
    return ranking_text(rank_candidates(results, metric, goal, {bounds}), width);
  });
  py::class_<SignedRank>(module, "SignedRank")
      .def(py::init<std::vector<double>>())
      .def("p", &SignedRank::p)
      .def("pseudo_median", &SignedRank::pseudo_median)
      .def("interval", &SignedRank::interval)
      .def("share_above", &SignedRank::share_above);
  module.def("differences_needed", differences_needed);
  module.def("holm", holm);
  module.def("holm_levels", holm_levels);
  module.def("binomial_cdf", binomial_cdf);
  module.def("mcnemar_exact", mcnemar_exact);
  module.def("share_interval", share_interval);
  module.def("quantile_interval", quantile_interval);
  module.def("estimated_median", estimated_median);
  module.def("quantile", quantile);
  module.def(
      "sensitivity_indices",
      [](const Eigen::MatrixXd& f, int replicates, double level, std::uint64_t seed) {
        return sensitivity_indices(f, {replicates, level, seed});
      },
      py::arg(), py::arg("replicates") = 1000, py::arg("level") = 0.95, py::arg("seed") = 1);
  module.def("quantiles",
             [](DistributionKind kind, double first, double second, const std::vector<double>& u) {
               const Distribution distribution(kind, first, second);
               std::vector<double> all;
               for (const double share : u) all.push_back(distribution.quantile(share));
               return all;
             });
  module.def("mersenne_twister", [](std::uint64_t seed, int n) {
    std::mt19937_64 engine(seed);
    std::vector<std::uint64_t> all(n);
    std::generate(all.begin(), all.end(), engine);
    return all;
  });
  module.def("points", points, py::arg(), py::arg(), py::arg(), py::arg(),
             py::arg("which") = py::none());
  module.def("sobol", [](Eigen::Index d, const std::vector<std::uint64_t>& which) {
    const SobolSequence sequence(d);
    Eigen::Matrix<std::uint64_t, Eigen::Dynamic, Eigen::Dynamic> all(which.size(), d);
    for (std::size_t i = 0; i < which.size(); ++i) {
      for (Eigen::Index j = 0; j < d; ++j) all(i, j) = sequence.coordinate(which[i], j);
    }
    return all;
  });
}

std::vector<double> moved(const AxisModel& model, const AxisValues& values, const AxisStart& start,
                          const AxisStretch& stretch) {
  std::vector<double> positions(stretch.times_s.size());
  model.move(values, start, stretch, positions);
  return positions;
}

void bind_identification(py::module_& module) {
  choice<AxisParameter>(module,
                        "AxisParameter inertia viscous coulomb breakaway stribeck_speed "
                        "motor_inertia load_inertia stiffness damping backlash motor_viscous "
                        "load_viscous motor_coulomb load_coulomb offset delay torque_constant");
  py::class_<AxisModel>(module, "AxisModel").def("move", moved);
  module.attr("friction_axis") = &friction_axis();
  module.attr("two_inertia_axis") = &two_inertia_axis(Side::motor);
  using R = RecordedAxis;
  record(module, "RecordedAxis times_s inputs positions input_times_s all_inputs", &R::times_s,
         &R::inputs, &R::positions, &R::input_times_s, &R::all_inputs);
  using D = AxisStretch;
  record(module, "AxisStretch input_times_s inputs times_s positions", &D::input_times_s,
         &D::inputs, &D::times_s, &D::positions);
  record(module, "AxisStart position velocity", &AxisStart::position, &AxisStart::velocity);
  record(module, "AxisData model stretches quantum", &AxisData::model, &AxisData::stretches,
         &AxisData::quantum);
  record(module, "AxisFit values noise_std", &AxisFit::values, &AxisFit::noise_std);
  using S = IdentificationSettings;
  record(module, "IdentificationSettings model has_stribeck known_inertia", &S::model,
         &S::has_stribeck, &S::known_inertia);
  using P = ParameterEstimate;
  record(module, "ParameterEstimate parameter value low high is_identifiable reason excitation",
         &P::parameter, &P::value, &P::low, &P::high, &P::is_identifiable, &P::reason,
         &P::excitation);
  record(module, "FitErrors rms normalised", &FitErrors::rms, &FitErrors::normalised);
  record(module, "Whiteness statistic limit", &Whiteness::statistic, &Whiteness::limit);
  using I = Identification;
  record(module,
         "Identification data fit free parameters is_bootstrapped is_converged errors whiteness "
         "held_out",
         &I::data, &I::fit, &I::free, &I::parameters, &I::is_bootstrapped, &I::is_converged,
         &I::errors, &I::whiteness, &I::held_out);
  module.def("identify_axis", identify_axis);
  module.def("holds", &I::holds);
  module.def("axis_data", axis_data);
  module.def("fit_starts", fit_starts);
  module.def("fitted_positions", fitted_positions);
  module.def("drawn_plants", drawn_plants);
  module.def("covariance_of",
             [](const I& found) { return covariance_of(found.data, found.free, found.fit); });
  module.def("rounding_step",
             [](const std::vector<double>& times_s) { return rounding_step(times_s); });
  using A = testing::AxisBench;
  record(module,
         "AxisBench inertia viscous coulomb breakaway stribeck_speed offset delay_s rate_Hz "
         "duration_s bits noise_counts mean_input swing starts_at_speed stamp_s",
         &A::inertia, &A::viscous, &A::coulomb, &A::breakaway, &A::stribeck_speed, &A::offset,
         &A::delay_s, &A::rate_Hz, &A::duration_s, &A::bits, &A::noise_counts, &A::mean_input,
         &A::swing, &A::starts_at_speed, &A::stamp_s);
  using B = testing::TwoInertiaBench;
  record(module,
         "TwoInertiaBench motor_inertia load_inertia stiffness damping backlash motor_viscous "
         "load_viscous motor_coulomb load_coulomb offset delay_s rate_Hz duration_s bits "
         "noise_counts mean_input swing starts_at_speed substeps",
         &B::motor_inertia, &B::load_inertia, &B::stiffness, &B::damping, &B::backlash,
         &B::motor_viscous, &B::load_viscous, &B::motor_coulomb, &B::load_coulomb, &B::offset,
         &B::delay_s, &B::rate_Hz, &B::duration_s, &B::bits, &B::noise_counts, &B::mean_input,
         &B::swing, &B::starts_at_speed, &B::substeps);
  module.def("record", &A::record);
  module.def("record", &B::record);
}

void bind_waves(py::module_& module) {
  using S = SeaState;
  record(module,
         "SeaState significant_height_m peak_period_s gamma heading_rad water_depth_m components "
         "seed",
         &S::significant_height_m, &S::peak_period_s, &S::gamma, &S::heading_rad, &S::water_depth_m,
         &S::components, &S::seed);
  py::class_<JonswapSpectrum>(module, "JonswapSpectrum")
      .def(py::init<const S&>())
      .def("density", py::vectorize(&JonswapSpectrum::density))
      .def("variance", &JonswapSpectrum::variance);
  using C = Waves::Component;
  record(module, "Component amplitude_m omega_rad_s wave_number_rad_m", &C::amplitude_m,
         &C::omega_rad_s, &C::wave_number_rad_m);
  record(module, "WaterMotion velocity acceleration slope", &WaterMotion::velocity,
         &WaterMotion::acceleration, &WaterMotion::slope);
  py::class_<Waves>(module, "Waves")
      .def(py::init<const S&, double>(), py::arg(), py::arg("slope_low_pass_s") = 0.0)
      .def("elevation", py::vectorize(&Waves::elevation))
      .def("at", &Waves::at)
      .def("components", &Waves::components);
  record(module, "SampledSpectrum omega_rad_s density", &SampledSpectrum::omega_rad_s,
         &SampledSpectrum::density);
  module.def("acceleration_spectrum", acceleration_spectrum);
  module.def("mean_acceleration_frequency", mean_acceleration_frequency);
  module.def("wave_number", wave_number);
}

void bind_wave_forces(py::module_& module) {
  using R = Resonator;
  record(module, "Resonator omega_rad_s damping std", &R::omega_rad_s, &R::damping, &R::std);
  using F = ForceSpectrum;
  record(module, "ForceSpectrum omega_rad_s density noise", &F::omega_rad_s, &F::density,
         &F::noise);
  using A = AxisNoise;
  record(module, "AxisNoise mass_kg position_std_m velocity_std_m_s bias_std_N period_s",
         &A::mass_kg, &A::position_std_m, &A::velocity_std_m_s, &A::bias_std_N, &A::period_s);
  module.def("force_noise_density",
             py::vectorize([](A axis, double omega) { return force_noise_density(axis, omega); }));
  module.def("spectral_density", py::vectorize([](R resonator, double omega) {
               return spectral_density(resonator, omega);
             }));
  module.def("resonator_step", resonator_step);
  module.def("resonator_noise", resonator_noise);
  module.def("fit_resonators", fit_resonators);
  module.def("fit_walk", fit_walk);
  module.def("total_std", total_std);
  module.def("mean_frequency", mean_frequency);
  using B = WaveForceBankDesign;
  record(module,
         "WaveForceBankDesign shapes mass_kg bias_std_N velocity_std_m_s position_std_m weakest_N "
         "strongest_N strengths memory_s settling_s period_s",
         &B::shapes, &B::mass_kg, &B::bias_std_N, &B::velocity_std_m_s, &B::position_std_m,
         &B::weakest_N, &B::strongest_N, &B::strengths, &B::memory_s, &B::settling_s, &B::period_s);
  py::class_<WaveForceBank>(module, "WaveForceBank")
      .def(py::init<const B&>())
      .def("reset", &WaveForceBank::reset)
      .def("update", py::vectorize(&WaveForceBank::update))
      .def("resonators", &WaveForceBank::resonators);
}

void bind_quadrotor(py::module_& module) {
  using P = QuadrotorParameters;
  record(module, "QuadrotorParameters mass_kg inertia_kgm2 linear_drag quadratic_drag", &P::mass_kg,
         &P::inertia_kgm2, &P::linear_drag, &P::quadratic_drag);
  py::class_<QuadrotorModel>(module, "QuadrotorModel")
      .def(py::init(
          [](const P& vehicle) { return QuadrotorModel(vehicle, QuadrotorPhysics::physical); }))
      .def("drag", [](const QuadrotorModel& model,
                      const Vector6d& velocity) { return model.parameters().drag(velocity); })
      .def("net_weight_N",
           [](const QuadrotorModel& model) { return model.parameters().net_weight_N(); })
      .def("accelerations", [](const QuadrotorModel& model, const Eigen::Vector3d& angles,
                               const Vector6d& velocity, const Eigen::Vector4d& U) {
        const AttitudeTrig attitude(angles);
        return std::pair(model.rigid_acceleration(attitude, velocity, U),
                         model.acceleration(attitude, velocity, U));
      });
  module.def("attitude_rates", [](const Eigen::Vector3d& angles, const Eigen::Vector3d& rates) {
    return attitude_rates(AttitudeTrig(angles), rates);
  });
  using N = ProcessNoiseStd;
  record(module, "ProcessNoiseStd velocity_std_m_s rate_std_rad_s", &N::velocity_std_m_s,
         &N::rate_std_rad_s);
  choice<AttitudeKinematics>(module, "AttitudeKinematics level exact");
  using Process = WaveForces<2, 2>;
  py::class_<Process>(module, "WaveForces")
      .def(py::init<const QuadrotorModel&, const N&, const ResonatorPair&, double, double,
                    AttitudeKinematics>())
      .def("nonlinear",
           [](const Process& process, const Process::Types::State& x, const Eigen::Vector4d& T) {
             Process::Types::Nonlinear g;
             process.nonlinear(x, T, g);
             return g;
           })
      .def("linear", [](const Process& process) { return Eigen::MatrixXd(process.linear()); })
      .def("set_torque_noise", &Process::set_torque_noise)
      .def("Q", [](const Process& process) { return Eigen::MatrixXd(process.Q()); });
  using Filter = Ukf<Process, 6>;
  py::class_<Filter>(module, "Ukf")
      .def(
          py::init([](const Process& process, const Eigen::MatrixXd& R, const Eigen::MatrixXd& P0) {
            return Filter(process, {.Q = process.Q(), .R = R, .P0 = P0});
          }))
      .def("predict", [](Filter& filter, const Eigen::Vector4d& T) { filter.predict(T); })
      .def("correct", [](Filter& filter, const Vector6d& y) { filter.correct(y); })
      .def("x", [](const Filter& filter) { return Eigen::VectorXd(filter.x()); })
      .def("P", [](const Filter& filter) { return Eigen::MatrixXd(filter.P()); });
  choice<QuadrotorFilter>(module, "QuadrotorFilter ukf ekf");
  choice<DisturbanceOrder>(module, "DisturbanceOrder none zero second resonator spectrum");
  using D = QuadrotorEstimatorDesign;
  record(module, "QuadrotorEstimatorDesign filter order waves", &D::filter, &D::order, &D::waves);
  module.def("check_estimator", [](const D& design) {
    make_quadrotor_estimator(design, QuadrotorModel({}, QuadrotorPhysics::physical));
  });
}

void bind_functions(py::module_& module) {
  using Function = double (*)(double);
  const std::pair<const char*, Function> functions[] = {{"sin", math::sin},
                                                        {"cos", math::cos},
                                                        {"tan", math::tan},
                                                        {"asin", math::asin},
                                                        {"acos", math::acos},
                                                        {"exp", math::exp},
                                                        {"expm1", math::expm1},
                                                        {"log", math::log},
                                                        {"tanh", math::tanh},
                                                        {"erfc", math::erfc},
                                                        {"mills_ratio", math::mills_ratio}};
  for (const auto& [name, function] : functions) module.def(name, py::vectorize(function));
  module.def("atan2", py::vectorize(math::atan2));
  module.def("pow", py::vectorize(math::pow));
  using Complex = std::complex<double>;
  module.def("sincos", py::vectorize([](double x) {
               const auto [sine, cosine] = math::sincos(x);
               return Complex(cosine, sine);
             }));
  module.def("complex_exp", [](const Complex& z) { return math::exp(z); });
  module.def("complex_log", [](const Complex& z) { return math::log(z); });
}

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
  record(module,
         "LmpcDesign A B prediction_steps control_steps Q Q_last R S change_bounds input_bounds "
         "state_bounds solver max_iterations on_infeasible softness",
         &D::A, &D::B, &D::prediction_steps, &D::control_steps, &D::Q, &D::Q_last, &D::R, &D::S,
         &D::change_bounds, &D::input_bounds, &D::state_bounds, &D::solver, &D::max_iterations,
         &D::on_infeasible, &D::softness);
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
      .def("optimise", &Lmpc::optimise)
      .def("solution", &Lmpc::solution, py::return_value_policy::copy)
      .def("statistics", &Lmpc::statistics, py::return_value_policy::copy)
      .def("iterations", &Lmpc::iterations)
      .def("softened_bounds", &Lmpc::softened_bounds)
      .def("inputs_are_feasible", &Lmpc::inputs_are_feasible)
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
  using P = PredictiveControlDesign;
  record(module,
         "PredictiveControlDesign lmpc disturbance_use cancel_at samples_per_move reference "
         "start_state force_limit",
         &P::lmpc, &P::disturbance_use, &P::cancel_at, &P::samples_per_move, &P::reference,
         &P::start_state, &P::force_limit);
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
        return std::make_unique<LqrControl>(idob(period_s), K, Eigen::Vector2d::Zero(),
                                            uses_true_state, force_limit);
      }))
      .def("disturbance", [disturbance](const LqrControl& law) { return disturbance(law); });
}

}  // namespace breakwater::python_methods

PYBIND11_MODULE(methods, module) {
  breakwater::python_methods::bind_statistics(module);
  breakwater::python_methods::bind_identification(module);
  breakwater::python_methods::bind_functions(module);
  breakwater::python_methods::bind_predictive_control(module);
  breakwater::python_methods::bind_waves(module);
  breakwater::python_methods::bind_wave_forces(module);
  breakwater::python_methods::bind_quadrotor(module);
}
