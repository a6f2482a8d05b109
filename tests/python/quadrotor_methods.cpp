// The sea, the wave force and the quadrotor, for tests in Python.
#include "methods.h"

#include <breakwater/control/quadrotor_estimator.h>
#include <breakwater/control/quadrotor_filters.h>
#include <breakwater/observers/resonator.h>
#include <breakwater/observers/wave_force_bank.h>
#include <breakwater/world/waves.h>

namespace breakwater::python_methods {
namespace {

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
  module.def("total_std", [](const ResonatorPair& pair) { return total_std(pair); });
  module.def("mean_frequency", [](const ResonatorPair& pair) { return mean_frequency(pair); });
  module.def("candidate_periods", candidate_periods);
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

}  // namespace

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
  bind_wave_forces(module);
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

}  // namespace breakwater::python_methods
