#include <breakwater/pictures/shot_list.h>

#include <filesystem>
#include <limits>

#include <breakwater/config/fields.h>

namespace breakwater {
namespace {

// How many tables [[NAME]] a file has.
std::size_t count_tables(const Config& config, const std::string& name) {
  std::size_t count = 0;
  const auto has = [&](std::size_t number) {
    const std::string prefix = name + "." + std::to_string(number) + ".";
    const auto next = config.entries().lower_bound(prefix);
    return next != config.entries().end() && next->first.starts_with(prefix);
  };
  while (has(count + 1)) ++count;
  return count;
}

std::string key_of(const std::string& table, std::size_t i, const char* key) {
  return table + "." + std::to_string(i + 1) + "." + key;
}

void bind_moments(Fields& fields, std::vector<ShotMoment>& moments) {
  for (std::size_t i = 0; i < moments.size(); ++i) {
    const auto key = [i](const char* name) { return key_of("moment", i, name); };
    fields.text(key("caption"), moments[i].caption, "below the picture");
    fields.number(key("at_s"), moments[i].at_s, not_negative(), "when [s]");
    fields.text(key("first_positive"), moments[i].first_positive,
                "a signal: when it is positive for the first time from at_s on; or empty");
    fields.number(key("plus_s"), moments[i].plus_s, any(), "so much later [s]");
  }
}

void bind_arrows(Fields& fields, std::vector<ShotArrow>& arrows) {
  for (std::size_t i = 0; i < arrows.size(); ++i) {
    const auto key = [i](const char* name) { return key_of("arrow", i, name); };
    fields.text(key("signal"), arrows[i].signal, "its length");
    fields.text(key("unit"), arrows[i].unit, "of the number beside it; empty: no number");
    fields.text(key("site"), arrows[i].site, "where it starts");
    fields.numbers(key("along"), arrows[i].along, any(), "where a positive value points");
    fields.choice(key("frame"), arrows[i].frame,
                  {{"world", ShotArrow::Frame::world}, {"site", ShotArrow::Frame::site}},
                  "whose axes along has");
    fields.numbers(key("offset_m"), arrows[i].offset_m, any(), "of its start from the site [m]");
    fields.number(key("metres_per_unit"), arrows[i].metres_per_unit, positive(), "its scale");
    fields.number(key("contact_mark_m"), arrows[i].contact_mark_m, not_negative(),
                  "radius of the ball at the site; 0: none [m]");
  }
}

void bind_lines(Fields& fields, std::vector<ShotLine>& lines) {
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const auto key = [i](const char* name) { return key_of("line", i, name); };
    fields.text(key("label"), lines[i].label, "in the legend");
    fields.text(key("value"), lines[i].value, "a signal, or a key of the configuration");
    fields.choice(key("style"), lines[i].style,
                  {{"solid", ShotLine::Style::solid}, {"dashed", ShotLine::Style::dashed}},
                  "solid or dashed");
  }
}

}  // namespace

ShotList read_shot_list(const std::string& file) {
  const Config config = read_config(file);
  ShotList shots;
  shots.moments.resize(count_tables(config, "moment"));
  shots.arrows.resize(count_tables(config, "arrow"));
  shots.lines.resize(count_tables(config, "line"));
  Fields fields;
  fields.text("title", shots.title, "in a lower corner");
  fields.text("camera", shots.camera, "one of the model's; empty: one that shows all of it");
  fields.number("video.from_s", shots.from_s, not_negative(), "[s]");
  fields.number("video.to_s", shots.to_s, positive(), "[s]");
  fields.number("video.speed", shots.speed, positive(), "0.1: ten times slower than life");
  fields.count("video.fps", shots.fps, between(1, 240), "frames a second");
  fields.count("video.width", shots.width, between(64, 7680), "[px]");
  fields.count("video.height", shots.height, between(64, 4320), "[px]");
  fields.text("chart.title", shots.chart_title, "quantity and unit");
  fields.choice("chart.corner", shots.chart_corner,
                {{"top-left", Corner::top_left},
                 {"top-right", Corner::top_right},
                 {"bottom-left", Corner::bottom_left},
                 {"bottom-right", Corner::bottom_right}},
                "where the chart is");
  bind_moments(fields, shots.moments);
  bind_arrows(fields, shots.arrows);
  bind_lines(fields, shots.lines);
  fields.read(config);
  if (const ConfigEntry* camera = config.find("camera")) shots.camera_origin = camera->origin;
  for (std::size_t i = 0; i < shots.arrows.size(); ++i) {
    shots.arrows[i].site_origin = config.find(key_of("arrow", i, "site"))->origin;
  }

  if (shots.to_s <= shots.from_s) config.fail("video.to_s", "must be after video.from_s");
  for (const char* key : {"video.width", "video.height"}) {
    const int pixels = std::string(key) == "video.width" ? shots.width : shots.height;
    if (pixels % 2 != 0) config.fail(key, "must be even");
  }
  for (std::size_t i = 0; i < shots.arrows.size(); ++i) {
    for (const char* key : {"along", "offset_m"}) {
      const auto& values =
          std::string(key) == "along" ? shots.arrows[i].along : shots.arrows[i].offset_m;
      if (values.size() != 3) config.fail(key_of("arrow", i, key), "must have 3 numbers");
    }
  }
  return shots;
}

ShotList shot_list(const std::filesystem::path& file) {
  if (std::filesystem::exists(file)) return read_shot_list(file.string());
  ShotList shots;
  shots.to_s = std::numeric_limits<double>::infinity();
  return shots;
}

}  // namespace breakwater
