#include <breakwater/program/scenario_program.h>
#include <breakwater/thesis/printed_references.h>

#include "arm_push/arm_push.h"
#include "arm_wall_contact/arm_wall_contact.h"
#include "cart_constrained/cart_constrained.h"
#include "cart_estimation/cart_estimation.h"
#include "cart_offset_free/cart_offset_free.h"
#include "cart_position/cart_position.h"
#include "impact_test/impact_test.h"
#include "motor_estimation/motor_estimation.h"
#include "plant/plant.h"
#include "two_inertia/two_inertia.h"

namespace breakwater {
namespace {

template <typename T>
std::unique_ptr<Scenario> make(const Catalogue& catalogue) {
  return std::make_unique<T>(catalogue);
}

}  // namespace

Catalogue axes_catalogue() {
  Catalogue catalogue;
  const auto add = [&](const char* name, auto make) { catalogue.add(ScenarioKind{name, make}); };
  add("arm_wall_contact", make<ArmWallContact>);
  add("arm_push", make<ArmPush>);
  add("cart_position", make<CartPosition>);
  add("cart_offset_free", make<CartOffsetFree>);
  add("cart_constrained", make<CartConstrained>);
  add("cart_estimation", make<CartEstimation>);
  add("motor_estimation", make<MotorEstimation>);
  add("two_inertia", make<TwoInertiaDrive>);
  add("impact_test", make<ImpactTest>);
  add("plant", make<Plant>);
  for (ArmControllerKind& kind : arm_controllers()) catalogue.add(std::move(kind));
  for (ContactLawKind& kind : contact_laws()) catalogue.add(std::move(kind));
  for (FrictionKind& kind : friction_laws()) catalogue.add(std::move(kind));
  for (AxisEstimatorKind& kind : axis_estimators()) catalogue.add(std::move(kind));
  for (AxisControllerKind& kind : axis_controllers()) catalogue.add(std::move(kind));
  for (PlantControllerKind& kind : plant_controllers()) catalogue.add(std::move(kind));
  catalogue.add(printed_references());
  return catalogue;
}

}  // namespace breakwater
