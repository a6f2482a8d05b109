// Models in XML: a URDF, and an MJCF as far as it is checked before the engine reads it.

#include <breakwater/plants/mjcf_tree.h>
#include <breakwater/plants/planar_chain.h>
#include "fuzz/input.h"

namespace breakwater {
namespace {

void read_urdf(const std::string& text) {
  const PlanarChain chain = load_planar_chain(fuzz::file_with(text));
  const Eigen::VectorXd q = Eigen::VectorXd::Zero(chain.joints());
  for (Eigen::Index i = 0; i < chain.joints(); ++i) {
    fuzz::require(chain.joint(i).link_mass_kg > 0.0, "a moving link has a mass");
  }
  fuzz::require(chain.tip_pose(q).allFinite() && chain.mass_matrix(q).allFinite(),
                "a chain is finite");
}

void read_mjcf(const std::string& text) {
  check_mjcf(fuzz::file_with(text), 1000);
}

constexpr fuzz::Parser kParsers[] = {{'u', "urdf", read_urdf}, {'m', "mjcf_check", read_mjcf}};

}  // namespace
}  // namespace breakwater

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return breakwater::fuzz::run_selected(breakwater::kParsers, data, size);
}
