#include <breakwater/rigs/plant_extras.h>

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
  const Fields::Under under(fields, prefix());
  fields.text("geom_1", geom_1, "geom of the model");
  fields.text("geom_2", geom_2, "geom of the model that may touch the first one");
}

}  // namespace breakwater
