#include "scenario/scenario.h"

#include "scenario/arm_push.h"
#include "scenario/arm_wall_contact.h"
#include "scenario/cart_constrained.h"
#include "scenario/cart_estimation.h"
#include "scenario/cart_offset_free.h"
#include "scenario/cart_position.h"
#include "scenario/motor_estimation.h"
#include "scenario/quadrotor_waves.h"

namespace breakwater {
namespace {

template <typename T>
std::unique_ptr<Scenario> make() {
  return std::make_unique<T>();
}

constexpr std::unique_ptr<Scenario> (*kMakers[])() = {
    make<ArmWallContact>,  make<ArmPush>,        make<CartPosition>,    make<CartOffsetFree>,
    make<CartConstrained>, make<CartEstimation>, make<MotorEstimation>, make<QuadrotorWaves>};

}  // namespace

std::vector<std::string> scenario_names() {
  std::vector<std::string> names;
  for (const auto& maker : kMakers) names.push_back(maker()->name());
  return names;
}

std::unique_ptr<Scenario> make_scenario(const std::string& name) {
  for (const auto& maker : kMakers) {
    auto scenario = maker();
    if (scenario->name() == name) return scenario;
  }
  throw std::invalid_argument("there is no scenario \"" + name + "\"" +
                              did_you_mean(name, scenario_names()));
}

}  // namespace breakwater
