// The friction laws that a joint chooses by name.
#pragma once

#include <vector>

#include <breakwater/experiment/parts.h>
#include <breakwater/world/friction_law.h>

namespace breakwater {

/// A friction law by its name: key friction.law. It is given F_C, the joint's Coulomb friction.
/// Null: the engine's own Coulomb friction.
struct FrictionKind : PartKind<FrictionLaw, double> {
  using PartKind::PartKind;
  static constexpr const char* kWhat = "friction law";
};

/// Breakwater's own.
std::vector<FrictionKind> friction_laws();

}  // namespace breakwater
