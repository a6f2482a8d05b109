// Identification, for tests in Python.
#include "methods.h"

#include <breakwater/identification/axis_intervals.h>
#include <breakwater/identification/identified_axis.h>
#include <breakwater/identification/identified_plants.h>
#include "identification/bench.h"

namespace breakwater::python_methods {
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
         "duration_s bits noise_counts mean_input swing starts_at_speed stamp_s substeps",
         &A::inertia, &A::viscous, &A::coulomb, &A::breakaway, &A::stribeck_speed, &A::offset,
         &A::delay_s, &A::rate_Hz, &A::duration_s, &A::bits, &A::noise_counts, &A::mean_input,
         &A::swing, &A::starts_at_speed, &A::stamp_s, &A::substeps);
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

}  // namespace breakwater::python_methods
