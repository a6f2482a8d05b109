#include <breakwater/rigs/plant_extras.h>

#include <breakwater/sim/named_elements.h>

namespace breakwater {

void PushSettings::bind(Fields& fields) {
  const Fields::Under under(fields, prefix());
  fields.text("body", body, "body of the model that the force pushes at its centre of mass");
  fields.numbers("along", along, any(), "direction of the force in the world, of any length");
  disturbance.bind(fields, "N", "N");
  for (const char* key : {"disturbance.frequency_rad_s", "disturbance.start_s"}) {
    fields.standard(key, {0.0});
  }
}

void ContactSettings::bind(Fields& fields) {
  {
    const Fields::Under under(fields, prefix());
    fields.text("geom_1", geom_1, "geom of the model");
    fields.text("geom_2", geom_2, "geom of the model that may touch the first one");
  }
  wall.bind(fields);
}

std::pair<std::string, std::string> ContactSettings::geoms(const Model& model) const {
  const bool is_plane_first = model->geom_type[geom_id(model, geom_1)] == mjGEOM_PLANE;
  return is_plane_first ? std::pair(geom_2, geom_1) : std::pair(geom_1, geom_2);
}

void ContactSettings::prepare(Model& model) const {
  const auto [geom, plane] = geoms(model);
  wall.prepare(model, geom, plane);
  if (make(model)) model.separate(geom_id(model, geom), geom_id(model, plane));
}

std::unique_ptr<WallContact> ContactSettings::make(const Model& model) const {
  if (wall.is_of_engine()) return nullptr;
  const auto [sphere, plane] = geoms(model);
  std::unique_ptr<WallContact> contact = wall.make(model, sphere, plane);
  contact->set_solid(true);
  return contact;
}

void TipSettings::bind(Fields& fields) {
  fields.text("tip.contact", contact,
              "name of the contact whose normal force is force_true_N; none: there is no such "
              "signal");
  fields.text("tip.sensor", sensor,
              "<force> or <touch> of the model that measures the force; none: the force of "
              "tip.contact is measured");
  fields.count(
      "tip.component", component, between(0, 2),
      "value of the sensor, from 0: 0 is the force with which the tip presses along x of its site");
  fields.standard("tip.contact", {std::string(kNone)});
  fields.standard("tip.sensor", {std::string(kNone)});
  fields.standard("tip.component", {std::int64_t{0}});
  chain.bind_filter(fields);
  chain.bind_noise(fields);
  chain.bind(fields);
  fields.number("force.reference_N", reference.value, any(),
                "reference of the force, for the controller and the log [N]");
  fields.number("force.from_s", reference.from_s, not_negative(),
                "time from which the reference counts; before, it is 0 [s]");
  for (const char* key : {"force.filter_time_constant_s", "sensor.force_noise_N",
                          "force.reference_N", "force.from_s"}) {
    fields.standard(key, {0.0});
  }
  fields.only_where({"tip.component", "sensor.force_tool_mass_kg", "sensor.force_weighed_kg"},
                    "tip.sensor names a sensor", [this] { return sensor != kNone; });
}

void TipSettings::add_tool(Model& model) const {
  if (sensor == kNone || chain.tool_mass_kg == 0.0) return;
  const int id = model.id(mjOBJ_SENSOR, sensor);
  model.add_mass(model->site_bodyid[model->sensor_objid[id]], chain.tool_mass_kg);
}

}  // namespace breakwater
