// Friction on a transmission, and refusals. tests/python/plants_test.py has the laws.
#include <breakwater/sim/external_force.h>
#include <breakwater/sim/joint_friction.h>
#include <breakwater/sim/simulation.h>
#include "sim/small_models.h"

namespace breakwater::joint_friction_test {

using testing::FunctionController;

// A disturbance on the load of a transmission does not press its teeth together; its torque does.
TEST(JointFriction, LoadOfATransmissionRubsByTheTorqueTransmitted) {
  for (const double torque_Nm : {0.0, 2.0}) {
    Model model = Model::load(testing::source_file("models/two_inertia.xml"));
    author_friction(model, model.id(mjOBJ_JOINT, "load"), 0.0, 0.1);
    Transmission transmission(model, "motor", "load", {.stiffness = 50.0});
    JointForce disturbance(model, "load");
    disturbance.hold(1.0);
    JointFriction friction(model, "load", std::make_unique<LoadDependentFriction>(0.1, 0.5),
                           &transmission);
    FunctionController controller(
        [](const Sample&, Eigen::Ref<Eigen::VectorXd> u) { u.setZero(); });
    SensingSetup sensing;
    sensing.channels = {{.name = "angle", .sensor = "load_pos"}};
    Simulation simulation(std::move(model), controller, sensing, 1);
    simulation.add(disturbance);
    simulation.add(transmission);
    simulation.add(friction);
    simulation.set_position(std::array{torque_Nm / 50.0, 0.0});
    simulation.set_velocity(std::array{1.0, 1.0});
    simulation.step();
    EXPECT_NEAR(friction.force(), -(0.1 + 0.5 * torque_Nm), 0.01) << torque_Nm;
  }
}

TEST(JointFriction, RefusesWhatIsNoFriction) {
  using Curve = StribeckFriction::Curve;
  const std::vector<std::function<void()>> wrong = {
      [] { StribeckFriction(Curve{.coulomb = 0.0}); },
      [] { StribeckFriction(Curve{.coulomb = 1.0, .static_ratio = 0.9}); },
      [] { StribeckFriction(Curve{.coulomb = 1.0, .velocity = 0.0}); },
      [] { StribeckFriction(Curve{.coulomb = 1.0, .exponent = 0.0}); },
      [] {
        StribeckFriction(Curve{.coulomb = 1.0}, {-1.0, 0.0});
      },
      [] {
        StribeckFriction(Curve{.coulomb = 1.0}, {1.0, std::nan("")});
      },
      [] { LoadDependentFriction(0.0, 0.1); },
      [] { LoadDependentFriction(1.0, 1.0); },
      [] { LoadDependentFriction(1.0, -0.1); }};
  for (std::size_t i = 0; i < wrong.size(); ++i) {
    EXPECT_REFUSED(wrong[i]()) << i;
  }
  Model model = Model::load(testing::source_file("models/cart.xml"));
  model.get()->opt.solver = mjSOL_PGS;
  EXPECT_TRUE(has(complaint_of([&] {
                    JointFriction(model, "rail",
                                  std::make_unique<StribeckFriction>(Curve{.coulomb = 1.0},
                                                                     Bristles{1.0, 0.0}));
                  }),
                  "friction with bristles needs the solver Newton or CG"));
}

}  // namespace breakwater::joint_friction_test
