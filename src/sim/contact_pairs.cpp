#include <breakwater/sim/contact_pairs.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <breakwater/sim/model_draft.h>

namespace breakwater {
namespace {

using Pair = std::pair<int, int>;

constexpr std::size_t kMostPairs = 4;
constexpr mjtNum kNever = -mjMAXVAL;  // a margin below every distance

// The pairs of a world geom and a geom of the only moving body, in the engine's order. Empty if
// other pairs are possible.
std::vector<Pair> possible_pairs(const mjModel& m) {
  std::vector<int> fixed, moving;
  for (int geom = 0; geom < m.ngeom; ++geom) {
    const int body = m.geom_bodyid[geom];
    // The engine's search finds a plane on a static body other than the world twice.
    if (body != 0 && m.body_weldid[body] == 0) return {};
    (body == 0 ? fixed : moving).push_back(geom);
  }
  if (fixed.size() * moving.size() > kMostPairs) return {};
  std::vector<Pair> pairs;
  for (const int geom : fixed) {
    for (const int other : moving) {
      if (m.geom_bodyid[other] != m.geom_bodyid[moving.front()]) return {};
      const bool is_ordered = m.geom_type[geom] <= m.geom_type[other];
      pairs.push_back(is_ordered ? Pair(geom, other) : Pair(other, geom));
    }
  }
  return pairs;
}

bool are_alike(const mjModel& m, const Pair& pair) {
  const auto same = [&](const auto* values, int columns) {
    const auto* one = values + at(pair.first, columns);
    return std::equal(one, one + columns, values + at(pair.second, columns));
  };
  const auto none = [&](const mjtNum* values) {
    return values[pair.first] == 0.0 && values[pair.second] == 0.0;
  };
  return same(m.geom_condim, 1) && same(m.geom_priority, 1) && same(m.geom_solmix, 1) &&
         same(m.geom_solref, mjNREF) && same(m.geom_solimp, mjNIMP) && same(m.geom_friction, 3) &&
         none(m.geom_margin) && none(m.geom_gap);
}

void write_pair(mjModel& m, int row, const Pair& pair) {
  const int geom = pair.first;
  m.pair_geom1[row] = pair.first;
  m.pair_geom2[row] = pair.second;
  m.pair_dim[row] = m.geom_condim[geom];
  std::copy_n(m.geom_solref + at(geom, mjNREF), mjNREF, m.pair_solref + at(row, mjNREF));
  std::copy_n(m.geom_solimp + at(geom, mjNIMP), mjNIMP, m.pair_solimp + at(row, mjNIMP));
  const mjtNum* friction = m.geom_friction + at(geom, 3);
  const mjtNum unpacked[5] = {friction[0], friction[0], friction[1], friction[2], friction[2]};
  std::copy_n(unpacked, 5, m.pair_friction + at(row, 5));
  m.name_pairadr[row] = m.nnames - 1;  // the end of the last name: no name
}

}  // namespace

mjModel* with_contact_pairs(const mjModel& model) {
  const bool is_plain = model.npair == 0 && model.nexclude == 0 &&
                        model.opt.collision == mjCOL_ALL &&
                        (model.opt.enableflags & mjENBL_OVERRIDE) == 0;
  if (!is_plain) return nullptr;
  const std::vector<Pair> pairs = possible_pairs(model);
  const bool are_all_alike = std::all_of(pairs.begin(), pairs.end(),
                                         [&](const Pair& pair) { return are_alike(model, pair); });
  if (pairs.empty() || !are_all_alike) return nullptr;
  mjModel sizes = model;
  sizes.npair = static_cast<int>(pairs.size());
  sizes.opt.collision = mjCOL_PAIR;
  ModelDraft draft(model, sizes, all_geoms(model));
  for (int i = 0; i < draft->npair; ++i) write_pair(*draft, i, pairs[static_cast<std::size_t>(i)]);
  switch_contact_pairs(*draft);
  std::string fatal;
  return draft.make(fatal);  // null if there is not enough memory
}

void switch_contact_pairs(mjModel& m) {
  for (int i = 0; i < m.npair; ++i) {
    const int a = m.pair_geom1[i];
    const int b = m.pair_geom2[i];
    const bool match = (m.geom_contype[a] & m.geom_conaffinity[b]) != 0 ||
                       (m.geom_contype[b] & m.geom_conaffinity[a]) != 0;
    m.pair_margin[i] = match ? 0.0 : kNever;
  }
}

}  // namespace breakwater
