// Scenario cart_offset_free: predictive control under input and output disturbance (2.3.6, 3.3.3).
#include <breakwater/rigs/axis_scenario.h>

namespace breakwater {
namespace {

// The cart must go to a position and stay there, while a force pushes it and its position sensor
// has an offset. Estimation is faster than control. The question is whether an error remains.
class CartOffsetFree final : public AxisScenario {
 public:
  explicit CartOffsetFree(const Catalogue& catalogue)
      : AxisScenario(catalogue, {.name = "cart_offset_free",
                                 .summary = "predictive control of a cart under input and output "
                                            "disturbance: the remaining error",
                                 .axis = cart_axis(),
                                 .controller = "mpc",
                                 .optimises = true}) {}

  AxisPlant plant() const override {
    AxisPlant plant = plant_;
    AxisSettings& axis = plant.axis();
    if (!noise_) axis.noise_std = axis.input_noise_std = 0.0;
    const auto step = [&](double amplitude) {
      return Disturbance{DisturbanceKind::step, amplitude, 0.0, disturbance_start_s_};
    };
    axis.force = step(disturbance_N_);
    axis.output = step(output_disturbance_m_);
    return plant;
  }

 private:
  void bind(Fields& fields) override {
    AxisSettings& axis = plant_.axis();
    fields.flag("noise.enabled", noise_, "add the noise");
    fields.only_where({"noise.std_m", "noise.input_std_N"}, "noise.enabled is true",
                      [this] { return noise_; });
    fields.number("reference.position_m", axis.reference.value, any(),
                  "r: reference of the position [m]");
    fields.number("reference.start_s", axis.reference.from_s, not_negative(),
                  "time of the step of the reference from 0 to r [s]");
    fields.number("disturbance.input_N", disturbance_N_, any(),
                  "d_i: input disturbance, which opposes the drive [N]");
    fields.number("disturbance.output_m", output_disturbance_m_, any(),
                  "d_o: output disturbance, added to the measured position [m]");
    fields.number("disturbance.start_s", disturbance_start_s_, not_negative(),
                  "time at which both disturbances begin [s]");
  }

  double disturbance_N_ = 0.0;
  double output_disturbance_m_ = 0.0;
  double disturbance_start_s_ = 0.0;
  bool noise_ = false;
};

}  // namespace

ScenarioKind cart_offset_free() {
  return scenario_kind<CartOffsetFree>("cart_offset_free");
}

}  // namespace breakwater
