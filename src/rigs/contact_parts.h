// The contact laws that a scenario chooses by name.
#pragma once

#include <vector>

#include <breakwater/experiment/parts.h>
#include <breakwater/world/contact_law.h>

namespace breakwater {

/// A contact law by its name: key contact.law, or contact.NAME.law of a plant. Its keys are bound
/// without that prefix: "stiffness_N_m".
struct ContactLawKind : PartKind<ContactForceLaw> {
  using PartKind::PartKind;
  static constexpr const char* kWhat = "contact law";
};

/// Breakwater's own.
std::vector<ContactLawKind> contact_laws();

}  // namespace breakwater
