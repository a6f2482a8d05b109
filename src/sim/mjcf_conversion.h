// Model files of MuJoCo 3 for the engine, which is MuJoCo 2.2.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <breakwater/plants/mjcf_tree.h>
#include <breakwater/sim/model.h>

namespace breakwater {

struct ConvertedMjcf {
  MjcfElement root;     ///< names its assets by absolute paths
  MjcfChanges changes;  ///< empty: the engine reads the file as it is
};

/// The model that MuJoCo 3 reads in an MJCF file, in the words of the engine. Its schema decides
/// what it knows: an element or attribute beyond it has a rule (a conversion, a loss, a refusal),
/// or is refused. A file of MuJoCo 2.2 and one of another root than <mujoco> have no changes.
/// Throws std::invalid_argument `FILE:LINE: reason` for what cannot be converted, and as
/// flat_mjcf() and load_mjcf().
///
/// Forces that the engine lacks are written into <custom> and user data. add_missing_forces()
/// adds them at each stage of the integrator: gravity compensation of bodies, and springs of
/// tendons with a slack.
ConvertedMjcf convert_mjcf(const std::string& file, std::uint64_t most_elements);

/// One line `FILE: …` that names the changes; none if there are none, or for another kind of file.
std::vector<std::string> conversion_warnings(const std::string& file);

/// The engine's model of a file, or of a text in place of the file. If the engine cannot make it,
/// returns null and sets `reason`.
ModelPointer load_mjcf(const std::string& file, const std::string& text, std::string& reason);

/// Makes the engine add the forces that a model of convert_mjcf() asks for, in this process.
void add_missing_forces(const mjModel& model);

}  // namespace breakwater
