#include "cli/program.h"

namespace breakwater {
namespace {
const std::string kQuadrotorFile = "scenarios/quadrotor_waves/quadrotor_waves.toml";
using testing::replaced;

class QuadrotorCommandLine : public testing::ProgramTest {};

TEST_F(QuadrotorCommandLine, NonsenseIsOneLineAndStatus2) {
  const std::string mjcf = testing::text_of(testing::source_file("models/quadrotor.xml"));
  write("no_site.xml",
        replaced(replaced(mjcf, "name=\"t3\"", "name=\"tx\""), "site=\"t3\"", "site=\"tx\""));
  expect_refusals(
      "quadrotor_waves --set ",
      {{"wave.significant_height_m=-1",
        "--set: wave.significant_height_m: must be 0 or more, is -1"},
       {"wave.peak_period_s=0", "--set: wave.peak_period_s: must be positive, is 0"},
       {"task.start_m=[0,0,1]", "--set: task.start_m: z must not be above the surface, z = 0"},
       {"task.reference_m=[0,0,0.5]",
        "--set: task.reference_m: z must not be above the surface, z = 0"},
       {"wave.water_depth_m=8",
        "PROJECT/" + kQuadrotorFile + ":" +
            testing::line_of(testing::text_of(testing::source_file(kQuadrotorFile)), "start_m") +
            ": task.start_m: z must be above "
            "the water's bottom"},
       {"reading=leteral",
        "--set: reading: there is no [readings.leteral] (did you mean literal?)"},
       {"estimator.measurement_covariance=true",
        "--set: estimator.measurement_covariance: must be one of printed, actual, is true"},
       {"task.reference_m=[0,0]", "--set: task.reference_m: must have 3 numbers: x, y and z"},
       {"model.mjcf=models/cart.xml", "PROJECT/models/cart.xml: needs 4 thrusters"},
       {"plant.added_mass_coefficient=-1",
        "--set: plant.added_mass_coefficient: must be 0 or more, is -1"},
       {"plant.added_mass_coefficient=1e300",
        "--set: plant.added_mass_coefficient: PROJECT/models/quadrotor.xml: body \"quadrotor\": "
        "mass is out of range"},
       {"wave.inertia_coefficient=2",
        "--set: wave.inertia_coefficient: must be 1 + plant.added_mass_coefficient = 1.5, is 2; "
        "leave it out"},
       {"plant.added_mass_coefficient=0 wave.inertia_coefficient=1.5",
        "--set: wave.inertia_coefficient: must be 1 + plant.added_mass_coefficient = 1, is 1.5; "
        "leave it out"},
       {"metrics.window_s=0", "--set: metrics.window_s: must be positive, is 0"},
       {"fault.sensor=q1",
        "--set: fault.sensor: must be one of none, x, y, z, roll, pitch, yaw, is \"q1\" (did you "
        "mean x?)"},
       {"model.mjcf=no_site.xml", "HERE/no_site.xml: has no site named \"t3\""}});
}

TEST_F(QuadrotorCommandLine, AVehicleOfAnotherMassIsALine) {
  write("heavy.xml", replaced(testing::text_of(testing::source_file("models/quadrotor.xml")),
                              "mass=\"1.38\"", "mass=\"3\""));
  const std::string brief = "quadrotor_waves --duration 0.1 --set metrics.window_s=0.05";
  EXPECT_TRUE(has(ran(brief + " model.mjcf=heavy.xml").err,
                  "model.mjcf: the vehicle has 3 kg; estimator and controller assume 1.38 kg"));
  EXPECT_TRUE(lacks(ran(brief).err, "assume"));
}

// At -10 m a wave of 8 s keeps e^{-ω² z/g} = 0.5331 of its vertical speed. The JONSWAP sea,
// integrated with NumPy from 0.5 to 3 ω_p, keeps 0.3973.
TEST_F(QuadrotorCommandLine, WavesDecayAsTheSeaDoesWhateverTheSeed) {
  for (const std::string seed : {"1", "2"}) {
    EXPECT_TRUE(has(ran("breakwater waves --height 2 --period 8 --seed " + seed).out,
                    "\n-10.0           0.5331          0.3973     0.3"));
  }
}

TEST_F(QuadrotorCommandLine, NanEndsTheRunWithStatus3) {
  const std::string broken =
      "quadrotor_waves --duration 2 --quiet --set metrics.window_s=1 fault.sensor=z fault.at_s=1";
  const testing::ProgramResult stopped = run(broken);
  EXPECT_EQ(stopped.status, 3);
  EXPECT_TRUE(has(stopped.err, "t = 1 s: sensor z is not finite"));
  ran(broken + " sensor.nan_policy=drop");
}

}  // namespace
}  // namespace breakwater
