#include <breakwater/pictures/shot_list.h>

#include <breakwater/config/fields.h>
#include <breakwater/config/toml_entry.h>
#include <breakwater/config/toml_file.h>

namespace breakwater {
namespace {

const Names<Corner> kCorners = {{"top-left", {false, false}},
                                {"top-right", {true, false}},
                                {"bottom-left", {false, true}},
                                {"bottom-right", {true, true}}};
const Names<bool> kFrames = {{"world", false}, {"site", true}};
const Names<bool> kStyles = {{"solid", false}, {"dashed", true}};

Eigen::Vector3d vector_of_three(const TomlEntry& entry) {
  std::vector<double> values;
  for (const TomlEntry& element : entry.elements()) values.push_back(element.number());
  if (values.size() != 3) entry.fail("must have 3 numbers");
  return {values[0], values[1], values[2]};
}

int even(const TomlEntry& pixels, std::int64_t most) {
  const std::int64_t count = pixels.whole(64, most);
  if (count % 2 != 0) pixels.fail("must be even");
  return static_cast<int>(count);
}

void read_video(const TomlEntry& video, ShotList& shots) {
  video.allow({"from_s", "to_s", "speed", "fps", "width", "height"});
  shots.from_s = video["from_s"].number(not_negative());
  shots.to_s = video["to_s"].number(positive());
  if (shots.to_s <= shots.from_s) video["to_s"].fail("must be after video.from_s");
  shots.style.speed = video["speed"].number(positive());
  shots.fps = static_cast<int>(video["fps"].whole(1, 240));
  shots.style.width = even(video["width"], 7680);
  shots.style.height = even(video["height"], 4320);
}

ShotMoment read_moment(const TomlEntry& moment) {
  moment.allow({"caption", "at_s", "first_positive", "plus_s"});
  return {moment["caption"].text_or_empty(), moment["at_s"].number(not_negative()),
          moment["first_positive"].text_or_empty(),
          moment["plus_s"].number_or_nothing().value_or(0.0)};
}

ShotArrow read_arrow(const TomlEntry& arrow) {
  arrow.allow({"signal", "unit", "site", "along", "frame", "offset_m", "metres_per_unit",
               "contact_mark_m"});
  ShotArrow shot;
  shot.track.signal = arrow["signal"].text();
  shot.track.unit = arrow["unit"].text_or_empty();
  shot.site = arrow["site"].text();
  shot.site_place = arrow["site"].place();
  shot.track.along = vector_of_three(arrow["along"]);
  shot.track.arrow.in_site_frame = arrow["frame"].choice(kFrames);
  shot.track.arrow.offset_m = vector_of_three(arrow["offset_m"]);
  shot.track.metres_per_unit = arrow["metres_per_unit"].number(positive());
  shot.track.arrow.contact_mark_m = arrow["contact_mark_m"].number(not_negative());
  return shot;
}

ShotPage read_page(const TomlEntry& page) {
  ShotPage read;
  if (!page) return read;
  page.allow({"camera", "opens_before", "metrics", "chart"});
  read.camera = page["camera"].text_or_nothing();
  read.opens_before = page["opens_before"].text_or_nothing();
  if (page["metrics"]) read.metrics = page["metrics"].texts();
  for (const TomlEntry& chart : page["chart"].elements()) {
    chart.allow({"title", "signals"});
    read.charts.push_back({chart["title"].text(), chart["signals"].texts()});
  }
  return read;
}

ShotLine read_line(const TomlEntry& line) {
  line.allow({"label", "value", "style"});
  return {line["label"].text_or_empty(), line["value"].text(), line["style"].choice(kStyles)};
}

}  // namespace

ShotList shot_list(const std::filesystem::path& file) {
  ShotList shots;
  if (!std::filesystem::exists(file)) return shots;
  const toml::table tables = parse_toml_file(file.string());
  const TomlEntry root(tables, file.string());
  root.allow({"title", "camera", "video", "moment", "arrow", "chart", "line", "page"});
  shots.style.title = root["title"].text_or_empty();
  shots.camera = root["camera"].text_or_empty();
  shots.camera_place = root["camera"].place();
  read_video(root["video"], shots);
  for (const TomlEntry& moment : root["moment"].elements()) {
    shots.moments.push_back(read_moment(moment));
  }
  for (const TomlEntry& arrow : root["arrow"].elements()) shots.arrows.push_back(read_arrow(arrow));
  root["chart"].allow({"title", "corner"});
  shots.style.chart_title = root["chart"]["title"].text_or_empty();
  root["chart"]["corner"].choice(kCorners, shots.style.chart_corner);
  for (const TomlEntry& line : root["line"].elements()) shots.lines.push_back(read_line(line));
  shots.page = read_page(root["page"]);
  return shots;
}

}  // namespace breakwater
