#include "bench/simbody_impacts.h"

#include <Simbody.h>

#include <cmath>

namespace simbody_bench {
namespace {

// A system with a half space whose face is at x.
struct Bench {
  explicit Bench(const Material& its_material)
      : matter(system),
        forces(system),
        contacts(system),
        set(contacts.createContactSet()),
        hunt_crossley(forces, contacts, set),
        material(its_material) {}

  void add_half_space(double x_m) {
    contacts.addBody(set, matter.Ground(), SimTK::ContactGeometry::HalfSpace(),
                     SimTK::Transform(SimTK::Vec3(x_m, 0, 0)));
    describe();
  }
  void add_sphere(SimTK::MobilizedBody& body, const SimTK::Vec3& center) {
    contacts.addBody(set, body, SimTK::ContactGeometry::Sphere(kRadius_m),
                     SimTK::Transform(center));
    describe();
  }
  // The material of the surface that was added last.
  void describe() {
    const double modulus =
        material.stiffness / (4.0 / 3.0 * std::sqrt(kRadius_m)) * std::pow(2.0, 1.5);
    hunt_crossley.setBodyParameters(SimTK::ContactSurfaceIndex(surfaces++), modulus,
                                    material.dissipation_s_m / 1.5, 0.0, 0.0, 0.0);
  }
  Pulse run(SimTK::State state, double duration_s) {
    SimTK::RungeKuttaMersonIntegrator integrator(system);
    integrator.setAccuracy(1e-9);
    integrator.setMaximumStepSize(kStep_s);
    SimTK::TimeStepper stepper(system, integrator);
    stepper.initialize(state);
    Pulse pulse;
    for (int k = 1; k * kStep_s < duration_s && !pulse.has_ended; ++k) {
      stepper.stepTo(k * kStep_s);
      const SimTK::State& now = integrator.getState();
      system.realize(now, SimTK::Stage::Dynamics);
      SimTK::Vector_<SimTK::SpatialVec> bodies;
      SimTK::Vector_<SimTK::Vec3> particles;
      SimTK::Vector mobilities;
      hunt_crossley.calcForceContribution(now, bodies, particles, mobilities);
      pulse.add(bodies[0][1][0]);  // on the half space, along x
    }
    return pulse;
  }

  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter;
  SimTK::GeneralForceSubsystem forces;
  SimTK::GeneralContactSubsystem contacts;
  SimTK::ContactSetIndex set;
  SimTK::HuntCrossleyForce hunt_crossley;
  Material material;
  int surfaces = 0;
};

SimTK::MassProperties mass(double mass_kg, double center_m, double xx, double yy) {
  const SimTK::Vec3 center(center_m, 0, 0);
  return {mass_kg, center, SimTK::Inertia(xx, yy, yy).shiftFromMassCenter(-center, mass_kg)};
}

}  // namespace

Pulse sphere_by_simbody(const Material& material, double speed_m_s) {
  Bench bench(material);
  bench.add_half_space(0.0);
  SimTK::MobilizedBody::Slider sphere(bench.matter.Ground(),
                                      SimTK::Body::Rigid(mass(1.0, 0.0, 1e-3, 1e-3)));
  bench.add_sphere(sphere, SimTK::Vec3(-kRadius_m, 0, 0));
  SimTK::State state = bench.system.realizeTopology();
  sphere.setOneQ(state, 0, -1e-3);
  sphere.setOneU(state, 0, speed_m_s);
  return bench.run(state, 2.0);
}

Pulse arm_by_simbody(const Material& material, double distance_m) {
  using SimTK::MobilizedBody;
  using SimTK::Transform;
  using SimTK::Vec3;
  Bench bench(material);
  bench.add_half_space(0.45 + distance_m);
  const SimTK::Body::Rigid link(mass(0.22, 0.1, 1e-5, 7.3333333333333333e-4));
  const SimTK::Body::Rigid motor(mass(0.77, 0.0, 3e-4, 3e-4));
  const Vec3 end(0.2, 0, 0);
  MobilizedBody::Pin link1(bench.matter.Ground(), link);
  MobilizedBody::Weld motor2(link1, Transform(end), motor, Transform());
  MobilizedBody::Pin link2(link1, Transform(end), link, Transform());
  MobilizedBody::Weld motor3(link2, Transform(end), motor, Transform());
  MobilizedBody::Pin link3(link2, Transform(end), SimTK::Body::Rigid(mass(0.2, 0.09, 1e-5, 5.4e-4)),
                           Transform());
  MobilizedBody::Weld tip(link3, Transform(Vec3(0.19, 0, 0)),
                          SimTK::Body::Rigid(mass(0.02, 0.0, 8e-7, 8e-7)), Transform());
  bench.add_sphere(tip, Vec3(0));
  std::array<MobilizedBody::Pin*, 3> joints = {&link1, &link2, &link3};
  for (std::size_t i = 0; i < 3; ++i) {
    SimTK::Force::MobilityConstantForce(bench.forces, *joints[i], 0, kTorques_Nm[i]);
  }
  SimTK::State state = bench.system.realizeTopology();
  for (std::size_t i = 0; i < 3; ++i) joints[i]->setOneQ(state, 0, kAngles_rad[i]);
  return bench.run(state, 2.0);
}

}  // namespace simbody_bench
