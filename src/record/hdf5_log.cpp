#include "record/hdf5_log.h"

#include <fmt/core.h>
#include <hdf5.h>
#include <hdf5_hl.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <mutex>
#include <stdexcept>

namespace breakwater {
namespace {

constexpr hsize_t kChunkRows = 8192;

// An HDF5 identifier that closes itself.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {
    if (id_ < 0) throw std::runtime_error("HDF5 error");
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle() { close_(id_); }
  operator hid_t() const { return id_; }  // NOLINT(google-explicit-constructor): as HDF5 takes it

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

void require(herr_t status) {
  if (status < 0) throw std::runtime_error("HDF5 error");
}

// Of variable length: h5py then gives a str, and not bytes.
void write_text(hid_t object, const char* name, const std::string& text) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  require(H5Tset_size(type, H5T_VARIABLE));
  require(H5Tset_cset(type, H5T_CSET_UTF8));
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  const char* const value = text.c_str();
  require(H5Awrite(attribute, type, &value));
}

// A dataset of rows × width (or just rows, if width is 1), with unit and description.
void write_dataset(hid_t group, const Signal& signal, const std::vector<double>& values,
                   std::size_t width, int deflate_level) {
  const std::array<hsize_t, 2> size = {values.size() / width, width};
  const int rank = width == 1 ? 1 : 2;
  const Handle space(H5Screate_simple(rank, size.data(), nullptr), H5Sclose);
  const Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  if (deflate_level > 0 && size[0] > 0) {
    const std::array<hsize_t, 2> chunk = {std::min(size[0], kChunkRows), width};
    require(H5Pset_chunk(properties, rank, chunk.data()));
    require(H5Pset_shuffle(properties));
    require(H5Pset_deflate(properties, static_cast<unsigned>(deflate_level)));
  }
  const Handle dataset(H5Dcreate2(group, signal.name.c_str(), H5T_IEEE_F64LE, space, H5P_DEFAULT,
                                  properties, H5P_DEFAULT),
                       H5Dclose);
  require(H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()));
  write_text(dataset, "unit", signal.unit);
  write_text(dataset, "description", signal.description);
}

void write_track(hid_t file, const Track& track, int deflate_level) {
  const Handle group(H5Gcreate2(file, track.name().c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                     H5Gclose);
  const Signal time{"time_s", "s", "time of each row of this group", {}};
  write_dataset(group, time, track.times(), 1, deflate_level);
  const Handle scale(H5Dopen2(group, "time_s", H5P_DEFAULT), H5Dclose);
  require(H5DSset_scale(scale, "time_s"));
  for (std::size_t i = 0; i < track.signals(); ++i) {
    const Signal& signal = track.signal(i);
    write_dataset(group, signal, track.values(i), signal.values.size(), deflate_level);
    const Handle dataset(H5Dopen2(group, signal.name.c_str(), H5P_DEFAULT), H5Dclose);
    require(H5DSattach_scale(dataset, scale, 0));
  }
}

std::string read_text(hid_t object, const char* name) {
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  require(H5Tset_size(type, H5T_VARIABLE));
  require(H5Tset_cset(type, H5T_CSET_UTF8));
  char* value = nullptr;
  require(H5Aread(attribute, type, &value));
  std::string text(value);
  require(H5free_memory(value));
  return text;
}

// The names of all links of a group, in their order.
std::vector<std::string> link_names(hid_t group) {
  H5G_info_t info{};
  require(H5Gget_info(group, &info));
  std::vector<std::string> names;
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    const auto get = [&](char* buffer, std::size_t size) {
      return H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, buffer, size,
                                H5P_DEFAULT);
    };
    std::string name(static_cast<std::size_t>(std::max<ssize_t>(0, get(nullptr, 0))), '\0');
    get(name.data(), name.size() + 1);
    names.push_back(name);
  }
  return names;
}

std::array<hsize_t, 2> size_of(hid_t dataset) {
  const Handle space(H5Dget_space(dataset), H5Sclose);
  std::array<hsize_t, 2> size = {0, 1};
  if (H5Sget_simple_extent_ndims(space) > 2) throw std::runtime_error("HDF5 error");
  require(H5Sget_simple_extent_dims(space, size.data(), nullptr));
  return size;
}

// Debian's serial HDF5 is not built thread-safe.
std::mutex hdf5_in_use;

}  // namespace

void write_hdf5_log(const std::string& file, const std::vector<Track>& tracks, int deflate_level) {
  const std::lock_guard lock(hdf5_in_use);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  try {
    const Handle handle(H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
    for (const Track& track : tracks) write_track(handle, track, deflate_level);
    require(H5Fflush(handle, H5F_SCOPE_GLOBAL));
  } catch (const std::runtime_error&) {
    throw OutputError(file + ": cannot be written (is the disk full?)");
  }
}

std::string hdf5_version() {
  unsigned major = 0;
  unsigned minor = 0;
  unsigned release = 0;
  H5get_libversion(&major, &minor, &release);
  return fmt::format("{}.{}.{}", major, minor, release);
}

SignalName signal_name(const std::string& text) {
  const std::size_t bracket = text.find('[');
  SignalName signal{text.substr(0, bracket)};
  if (bracket == std::string::npos) return signal;
  const char* const end = text.data() + text.size();
  const auto [last, error] = std::from_chars(text.data() + bracket + 1, end, signal.index);
  if (error != std::errc() || signal.index < 1 || last + 1 != end || *last != ']') {
    throw std::invalid_argument("signal " + text + ": must be NAME, GROUP/NAME or NAME[1]");
  }
  return signal;
}

std::string LogEntry::unit_of(std::size_t index) const {
  constexpr std::string_view kComma = ", ";
  std::vector<std::string> units;
  std::size_t from = 0;
  for (std::size_t comma = unit.find(kComma); comma != std::string::npos;
       comma = unit.find(kComma, from)) {
    units.push_back(unit.substr(from, comma - from));
    from = comma + kComma.size();
  }
  units.push_back(unit.substr(from));
  return units.size() == width && index >= 1 && index <= width ? units[index - 1] : unit;
}

std::vector<LogEntry> list_hdf5_signals(const std::string& file) {
  const std::lock_guard lock(hdf5_in_use);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  try {
    const Handle handle(H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
    std::vector<LogEntry> entries;
    for (const std::string& track : link_names(handle)) {
      const Handle group(H5Gopen2(handle, track.c_str(), H5P_DEFAULT), H5Gclose);
      for (const std::string& name : link_names(group)) {
        if (name == "time_s") continue;
        const Handle data(H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose);
        const std::array<hsize_t, 2> size = size_of(data);
        entries.push_back({track, name, read_text(data, "unit"), read_text(data, "description"),
                           size[0], size[1]});
      }
    }
    return entries;
  } catch (const std::runtime_error&) {
    throw std::invalid_argument(file + ": is not a log");
  }
}

LoggedSignal read_hdf5_signal(const std::string& file, const std::string& dataset) {
  const std::lock_guard lock(hdf5_in_use);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  try {
    const Handle handle(H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
    const Handle data(H5Dopen2(handle, dataset.c_str(), H5P_DEFAULT), H5Dclose);
    const std::array<hsize_t, 2> size = size_of(data);
    LoggedSignal signal{size[0], size[1], std::vector<double>(size[0] * size[1])};
    require(H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, signal.values.data()));
    return signal;
  } catch (const std::runtime_error&) {
    throw std::invalid_argument(file + ": is not a log, or has no " + dataset);
  }
}

}  // namespace breakwater
