// Models for MuJoCo's compiler: an MJCF through our loader, and the file of a plant with its axes,
// contacts and metrics on a small MJCF. A plant that is read and printed is read again as the same.
#include <breakwater/config/config.h>
#include <breakwater/rigs/axis_scenario.h>
#include <breakwater/rigs/contact_settings.h>
#include <breakwater/rigs/drive_settings.h>
#include <breakwater/sim/model.h>
#include "fuzz/input.h"

namespace breakwater {
namespace {

constexpr const char* kModel = R"(<mujoco>
  <compiler angle="radian" autolimits="true"/>
  <worldbody>
    <geom name="stop" type="box" pos="0.2 0.2 0.1" size="0.02 0.02 0.02"/>
    <body name="rotor">
      <inertial pos="0 0 0" mass="1" diaginertia="0.01 0.01 0.01"/>
      <joint name="motor" type="hinge" axis="0 0 1"/>
    </body>
    <body name="load" pos="0 0 0.1">
      <inertial pos="0 0 0" mass="1" diaginertia="0.01 0.01 0.02"/>
      <joint name="load" type="hinge" axis="0 0 1" damping="0.01"/>
      <geom name="arm" type="capsule" fromto="0 0 0 0.2 0 0" size="0.01" mass="0"/>
    </body>
  </worldbody>
  <actuator><motor name="motor" joint="motor" ctrlrange="-10 10"/></actuator>
  <keyframe><key name="bent" qpos="0.1 0.2"/></keyframe>
</mujoco>)";

void read_model(const std::string& text) {
  const std::string file = fuzz::file_with(text);
  const Model whole = Model::load({file, 1000});
  const Model model = Model::load_physics({file, 1000});
  fuzz::require(model->nv == whole->nv, "a part has the same degrees of freedom");
  model.make_data();
}

const Catalogue& parts() {
  static const Catalogue all = [] {
    Catalogue made;
    for (ContactLawKind& kind : contact_laws()) made.add(std::move(kind));
    for (FrictionKind& kind : friction_laws()) made.add(std::move(kind));
    for (AxisEstimatorKind& kind : axis_estimators()) made.add(std::move(kind));
    for (AxisEstimatorKind& kind : published_estimators()) made.add(std::move(kind));
    for (AxisControllerKind& kind : axis_controllers()) made.add(std::move(kind));
    for (PlantControllerKind& kind : plant_controllers()) made.add(std::move(kind));
    return made;
  }();
  return all;
}

// The first case as the run folder has it, after all checks of a run.
std::string printed(const std::string& text) {
  const ScenarioFile file(fuzz::folder().write("plant.toml", text), "plant");
  const std::string name = file.default_case();
  const Config config = file.config(name);
  AxisScenario plant(parts(), {"plant", "any plant"});
  plant.learn(config);
  Fields fields = plant.fields();
  fields.check(file);
  fields.read(config);
  plant.check(config, fields);
  plant.metric_definitions();
  fields.unused();
  return fields.print("plant", name);
}

void read_plant(const std::string& text) {
  static const std::string model = fuzz::folder().write("m.xml", kModel);
  static const std::string table = fuzz::folder().write("t.csv", "time_s,value\n0,0\n1,1\n");
  const std::string first = printed(text);
  try {
    fuzz::require(printed(first) == first, "a printed configuration reads as it is");
  } catch (const std::invalid_argument& error) {
    std::fprintf(stderr, "%s\n%s\n", first.c_str(), error.what());
    fuzz::require(false, "a printed configuration is accepted");
  }
}

constexpr fuzz::Parser kParsers[] = {{'m', "mjcf", read_model}, {'p', "plant", read_plant}};

}  // namespace
}  // namespace breakwater

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return breakwater::fuzz::run_selected(breakwater::kParsers, data, size);
}
