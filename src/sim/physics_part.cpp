#include <breakwater/sim/physics_part.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <breakwater/sim/model_draft.h>

namespace breakwater {
namespace {

// The parts of the model that stay.
struct Kept {
  std::vector<int> geoms;  // in increasing order
  bool looks = false;      // cameras, lights, textures, materials, skins
  bool meshes = false;
  bool height_fields = false;
};

bool is_wrapped_around(int wrap) {
  return wrap == mjWRAP_SPHERE || wrap == mjWRAP_CYLINDER;
}

// Calls visit(type, id) for each element that a sensor or a tuple names; the id may be −1.
template <typename Visit>
void for_each_named(const mjModel& m, Visit visit) {
  for (int i = 0; i < m.nsensor; ++i) {
    visit(m.sensor_objtype[i], m.sensor_objid[i]);
    visit(m.sensor_reftype[i], m.sensor_refid[i]);
  }
  for (int i = 0; i < m.ntupledata; ++i) visit(m.tuple_objtype[i], m.tuple_objid[i]);
}

// The pairs of geoms that can collide. The kept `geoms` match every geom that can touch something.
class Collisions {
 public:
  Collisions(const mjModel& m, const std::vector<int>& geoms)
      : m_(m),
        contype_(m.geom_contype, m.geom_contype + m.ngeom),
        conaffinity_(m.geom_conaffinity, m.geom_conaffinity + m.ngeom) {
    m_.geom_contype = contype_.data();
    m_.geom_conaffinity = conaffinity_.data();
    // All bits are set, because the run may make them collide with anything.
    for (const int geom : geoms) m_.geom_contype[geom] = m_.geom_conaffinity[geom] = ~0;
  }

  // Geoms that are welded together never touch.
  bool can_touch(int a, int b) const {
    return bits_match(m_, a, b) &&
           m_.body_weldid[m_.geom_bodyid[a]] != m_.body_weldid[m_.geom_bodyid[b]];
  }
  bool can_touch_any(int geom) const {
    for (int other = 0; other < m_.ngeom; ++other) {
      if (can_touch(geom, other)) return true;
    }
    return false;
  }
  // The largest possible number of contacts at one time.
  std::size_t most_contacts() const {
    std::size_t most = 0;
    for (int a = 0; a < m_.ngeom; ++a) {
      for (int b = 0; b < a; ++b) {
        if (can_touch(a, b)) most += most_of_pair(a, b);
      }
    }
    for (int pair = 0; pair < m_.npair; ++pair) {
      most += most_of_pair(m_.pair_geom1[pair], m_.pair_geom2[pair]);
    }
    return most;
  }

 private:
  // A sphere touches a plane or a sphere at one point. MuJoCo 2.2.2 may find a pair twice.
  std::size_t most_of_pair(int a, int b) const {
    const auto is_simple = [this](int sphere, int other) {
      const int type = m_.geom_type[other];
      return m_.geom_type[sphere] == mjGEOM_SPHERE &&
             (type == mjGEOM_PLANE || type == mjGEOM_SPHERE);
    };
    return 2 * (is_simple(a, b) || is_simple(b, a) ? 1 : mjMAXCONPAIR);
  }

  mjModel m_;
  std::vector<int> contype_;
  std::vector<int> conaffinity_;
};

Kept what_stays(const mjModel& m, const std::vector<int>& geoms, const Collisions& collisions) {
  Kept kept;
  std::vector<bool> stays(static_cast<std::size_t>(m.ngeom), false);
  const auto keep = [&](int geom) { stays[static_cast<std::size_t>(geom)] = true; };
  for (const int geom : geoms) keep(geom);
  for_each_named(m, [&](int type, int id) {
    if (id < 0) return;
    if (type == mjOBJ_GEOM) keep(id);
    kept.looks |= type == mjOBJ_CAMERA || type == mjOBJ_LIGHT || type == mjOBJ_TEXTURE ||
                  type == mjOBJ_MATERIAL || type == mjOBJ_SKIN;
    kept.meshes |= type == mjOBJ_MESH;
    kept.height_fields |= type == mjOBJ_HFIELD;
  });
  for (int i = 0; i < m.nwrap; ++i) {
    if (is_wrapped_around(m.wrap_type[i])) keep(m.wrap_objid[i]);
  }
  for (int i = 0; i < m.npair; ++i) {
    keep(m.pair_geom1[i]);
    keep(m.pair_geom2[i]);
  }
  const bool is_seen = std::any_of(m.sensor_type, m.sensor_type + m.nsensor, [](int type) {
    return type == mjSENS_RANGEFINDER || type == mjSENS_USER;
  });
  // A ray passes through a geom with a transparent material.
  kept.looks |= is_seen;
  for (int i = 0; i < m.ngeom; ++i) {
    const bool is_in_fluid = m.geom_fluid[static_cast<std::ptrdiff_t>(mjNFLUID) * i] > 0.0;
    if (is_seen || is_in_fluid || collisions.can_touch_any(i)) keep(i);
    if (!stays[static_cast<std::size_t>(i)]) continue;
    kept.geoms.push_back(i);
    const bool has_data = m.geom_dataid[i] >= 0;
    kept.height_fields |= has_data && m.geom_type[i] == mjGEOM_HFIELD;
    kept.meshes |= has_data && m.geom_type[i] != mjGEOM_HFIELD;
  }
  return kept;
}

void set_sizes(mjModel& m, const Kept& kept, std::size_t most_contacts) {
  m.ngeom = static_cast<int>(kept.geoms.size());
  const auto drop = [](auto&... sizes) { ((sizes = 0), ...); };
  if (!kept.looks) {
    drop(m.ncam, m.nlight, m.ntex, m.ntexdata, m.nmat, m.nskin, m.nskinvert, m.nskintexvert,
         m.nskinface, m.nskinbone, m.nskinbonevert);
  }
  if (!kept.meshes) drop(m.nmesh, m.nmeshvert, m.nmeshtexvert, m.nmeshface, m.nmeshgraph);
  if (!kept.height_fields) drop(m.nhfield, m.nhfielddata);

  // At least one of each: with 0, the engine would not report an overflow.
  const auto at_most = [](int& size, std::size_t most) {
    if (static_cast<std::size_t>(size) > most) size = static_cast<int>(most);
  };
  constexpr std::size_t kRowsOfContact = 10;  // pyramidal friction cone in 6 dimensions
  at_most(m.nconmax, std::max<std::size_t>(most_contacts, 1));
  const int others = m.nemax + m.nv + 2 * m.njnt + 3 * m.ntendon;  // equalities, friction, limits
  at_most(m.njmax, static_cast<std::size_t>(others) +
                       kRowsOfContact * static_cast<std::size_t>(std::max(m.nconmax, 1)));
}

// Replaces the old ids of geoms and materials by the new ones.
void renumber(mjModel& m, const mjModel& full, const Kept& kept) {
  std::vector<int> number(static_cast<std::size_t>(full.ngeom), -1);
  for (std::size_t i = 0; i < kept.geoms.size(); ++i) {
    number[static_cast<std::size_t>(kept.geoms[i])] = static_cast<int>(i);
  }
  const auto renumber_geom = [&](int& geom) {
    if (geom >= 0) geom = number[static_cast<std::size_t>(geom)];
  };
  std::fill_n(m.body_geomnum, m.nbody, 0);
  std::fill_n(m.body_geomadr, m.nbody, -1);
  for (int i = 0; i < m.ngeom; ++i) {
    const int body = m.geom_bodyid[i];
    if (m.body_geomnum[body]++ == 0) m.body_geomadr[body] = i;
  }
  for (int i = 0; i < m.npair; ++i) {
    renumber_geom(m.pair_geom1[i]);
    renumber_geom(m.pair_geom2[i]);
  }
  for (int i = 0; i < m.nwrap; ++i) {
    if (is_wrapped_around(m.wrap_type[i])) renumber_geom(m.wrap_objid[i]);
  }
  for_each_named(m, [&](int type, int& id) {
    if (type == mjOBJ_GEOM) renumber_geom(id);
  });
  if (kept.looks) return;
  std::fill_n(m.geom_matid, m.ngeom, -1);
  std::fill_n(m.site_matid, m.nsite, -1);
  std::fill_n(m.tendon_matid, m.ntendon, -1);
}

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

ModelPointer physics_part(const mjModel& full, const std::vector<int>& geoms,
                          const std::string& file) {
  const Collisions collisions(full, geoms);
  const Kept kept = what_stays(full, geoms, collisions);
  mjModel sizes = full;
  set_sizes(sizes, kept, collisions.most_contacts());
  ModelDraft part(full, sizes, &kept.geoms);
  renumber(*part, full, kept);
  return part.make(file);
}

ModelPointer with_contact_pairs(const mjModel& model, const std::string& file) {
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
  ModelDraft draft(model, sizes);
  for (int i = 0; i < draft->npair; ++i) write_pair(*draft, i, pairs[static_cast<std::size_t>(i)]);
  switch_contact_pairs(*draft);
  return draft.make(file);
}

void switch_contact_pairs(mjModel& m) {
  for (int i = 0; i < m.npair; ++i) {
    m.pair_margin[i] = bits_match(m, m.pair_geom1[i], m.pair_geom2[i]) ? 0.0 : kNever;
  }
}

}  // namespace breakwater
