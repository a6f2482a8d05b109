#include <breakwater/record/hdf5_log.h>

#include <fcntl.h>
#include <fmt/core.h>
#include <hdf5.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <csignal>
#include <cstring>
#include <fstream>
#include <mutex>
#include <ranges>
#include <span>
#include <stdexcept>

#include <breakwater/record/text_outputs.h>

namespace breakwater {
namespace {

constexpr const char* kTimeBase = "time_s";
constexpr hsize_t kChunkRows = 8192;
constexpr std::size_t kMemoryStep = 1 << 18;  // by which a file in memory grows: HDF5 clears it
constexpr std::size_t kFileBytes = 1 << 16;   // the most in a file without datasets
constexpr std::size_t kHeaderBytes = 2048;    // approximate size of a dataset's header
constexpr std::size_t kSieveBytes = 1 << 16;  // HDF5 may write so much for one value
constexpr std::size_t kLongestText = 1 << 16;
// The largest ratio of deflate compression.
constexpr hsize_t kMostDeflated = 1032;
// Limits of the processor's time for reading a foreign log. An intact log takes far less.
constexpr rlim_t kForeignSeconds = 10;
constexpr rlim_t kBytesASecond = 5'000'000;
constexpr rlim_t kForeignMemory = 1'000'000'000;

using Size = std::array<hsize_t, 2>;  // rows, width

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

void check(bool is_sound) {
  if (!is_sound) throw std::runtime_error("not what a log holds");
}

void write_attribute(hid_t object, const char* name, hid_t type, hid_t space, const void* data) {
  const Handle attribute(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  require(H5Awrite(attribute, type, data));
}

// The length is fixed: HDF5 crashes on a damaged text of variable length.
void write_text(hid_t object, const char* name, const std::string& text) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  require(H5Tset_size(type, std::max<std::size_t>(1, text.size())));
  require(H5Tset_strpad(type, H5T_STR_NULLPAD));
  require(H5Tset_cset(type, H5T_CSET_UTF8));
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  write_attribute(object, name, type, space, text.c_str());
}

// A dataset of rows × width (or just rows, if width is 1), with unit and description. Returns its
// place in the file. Without `values`, only the first one is written: HDF5 then chooses the place.
std::uint64_t write_dataset(hid_t group, const LogEntry& entry, const double* values,
                            int deflate_level) {
  const Size size = {entry.rows, entry.width};
  const int rank = entry.width == 1 ? 1 : 2;
  const Handle space(H5Screate_simple(rank, size.data(), nullptr), H5Sclose);
  const Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  require(H5Pset_obj_track_times(properties, false));  // so that equal runs give equal files
  if (deflate_level > 0 && size[0] > 0) {
    const Size chunk = {std::min(size[0], kChunkRows), size[1]};
    require(H5Pset_chunk(properties, rank, chunk.data()));
    require(H5Pset_shuffle(properties));
    require(H5Pset_deflate(properties, static_cast<unsigned>(deflate_level)));
  }
  const Handle dataset(H5Dcreate2(group, entry.name.c_str(), H5T_IEEE_F64LE, space, H5P_DEFAULT,
                                  properties, H5P_DEFAULT),
                       H5Dclose);
  haddr_t place = 0;
  if (values != nullptr && size[0] > 0) {
    require(H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values));
  } else if (size[0] > 0) {
    const Size first = {0, 0}, one = {1, 1};
    const double nothing = 0.0;
    const Handle cell(H5Screate_simple(rank, one.data(), nullptr), H5Sclose);
    require(H5Sselect_hyperslab(space, H5S_SELECT_SET, first.data(), nullptr, one.data(), nullptr));
    require(H5Dwrite(dataset, H5T_NATIVE_DOUBLE, cell, space, H5P_DEFAULT, &nothing));
    place = H5Dget_offset(dataset);
    check(place != HADDR_UNDEF);
  }
  write_text(dataset, "unit", entry.unit);
  write_text(dataset, "units", entry.unit);  // the name in other conventions
  write_text(dataset, "description", entry.description);
  return place;
}

// The group of `datasets`, which all have one.
Handle make_group(hid_t file, const LogEntry& first) {
  return {H5Gcreate2(file, first.group.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose};
}

void write_track(hid_t file, const Track& track, int deflate_level) {
  const std::vector<LogEntry> datasets = datasets_of(track, track.rows());
  const Handle group = make_group(file, datasets.front());
  for (std::size_t i = 0; i < datasets.size(); ++i) {
    const std::span<const double> values = i == 0 ? track.times() : track.values(i - 1);
    write_dataset(group, datasets[i], values.data(), deflate_level);
  }
}

// Empty if there is no text, or one that write_text() did not write.
std::string read_text(hid_t object, const char* name) {
  if (H5Aexists(object, name) <= 0) return "";
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  const Handle type(H5Aget_type(attribute), H5Tclose);
  const Handle space(H5Aget_space(attribute), H5Sclose);
  const std::size_t size = H5Tget_size(type);
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) != 0 || size == 0 ||
      size > kLongestText || H5Sget_simple_extent_type(space) != H5S_SCALAR) {
    return "";
  }
  std::string text(size, '\0');
  require(H5Aread(attribute, type, text.data()));
  text.resize(std::min(size, text.find('\0')));
  return text;
}

// Whether the object is in the group itself: a soft or external link could lead out of the file.
bool is_own(hid_t group, const std::string& name) {
  H5L_info_t info{};
  require(H5Lget_info(group, name.c_str(), &info, H5P_DEFAULT));
  return info.type == H5L_TYPE_HARD;
}

// The names of all objects of a group, in their order.
std::vector<std::string> object_names(hid_t group) {
  H5G_info_t info{};
  require(H5Gget_info(group, &info));
  std::vector<std::string> names;
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    const auto get = [&](char* buffer, std::size_t size) {
      const ssize_t length =
          H5Lget_name_by_idx(group, ".", H5_INDEX_NAME, H5_ITER_INC, i, buffer, size, H5P_DEFAULT);
      if (length <= 0) throw std::runtime_error("HDF5 error");
      return static_cast<std::size_t>(length);
    };
    std::string name(get(nullptr, 0), '\0');
    get(name.data(), name.size() + 1);
    if (is_own(group, name)) names.push_back(name);
  }
  return names;
}

// Requires data in the file itself, and filters that need no plug-in.
void check_storage(hid_t dataset, const Size& size) {
  const Handle properties(H5Dget_create_plist(dataset), H5Pclose);
  const H5D_layout_t layout = H5Pget_layout(properties);
  check(layout == H5D_CONTIGUOUS || layout == H5D_CHUNKED);
  check(H5Pget_external_count(properties) == 0);

  hsize_t bytes = 0;
  const Handle file(H5Iget_file_id(dataset), H5Fclose);
  require(H5Fget_filesize(file, &bytes));
  bytes = std::min(bytes, H5Dget_storage_size(dataset));
  if (layout == H5D_CHUNKED) {
    bytes *= kMostDeflated;
    Size chunk = {1, 1};
    require(H5Pget_chunk(properties, 2, chunk.data()));
    check(chunk[0] <= size[0] && chunk[1] <= size[1]);
    const int filters = H5Pget_nfilters(properties);
    for (int i = 0; i < filters; ++i) {
      std::size_t no_values = 0;
      const H5Z_filter_t filter = H5Pget_filter2(properties, static_cast<unsigned>(i), nullptr,
                                                 &no_values, nullptr, 0, nullptr, nullptr);
      check(filter == H5Z_FILTER_DEFLATE || filter == H5Z_FILTER_SHUFFLE);
    }
  }
  check(size[0] <= bytes / sizeof(double) / size[1]);
}

// Throws unless write_dataset() may have written the dataset: a damaged size could take all memory.
Size checked_size(hid_t dataset) {
  const Handle type(H5Dget_type(dataset), H5Tclose);
  check(H5Tequal(type, H5T_IEEE_F64LE) > 0);
  const Handle space(H5Dget_space(dataset), H5Sclose);
  const int rank = H5Sget_simple_extent_ndims(space);
  check(rank == 1 || rank == 2);
  Size size = {0, 1};
  require(H5Sget_simple_extent_dims(space, size.data(), nullptr));
  check(size[1] > 0);
  if (size[0] > 0) check_storage(dataset, size);
  return size;
}

// HDF5 may be built without safety for threads, though Debian's has it.
std::mutex hdf5_in_use;

// The bytes of the log. HDF5 does not write the file itself: after a full disk it crashes at exit.
std::string file_image(const std::string& file, const std::vector<Track>& tracks,
                       int deflate_level) {
  const std::lock_guard lock(hdf5_in_use);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  try {
    const Handle in_memory(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    require(H5Pset_fapl_core(in_memory, kMemoryStep, false));
    const Handle handle(H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, in_memory), H5Fclose);
    for (const Track& track : tracks) write_track(handle, track, deflate_level);
    require(H5Fflush(handle, H5F_SCOPE_GLOBAL));
    const ssize_t size = H5Fget_file_image(handle, nullptr, 0);
    check(size > 0);
    std::string bytes(static_cast<std::size_t>(size), '\0');
    check(H5Fget_file_image(handle, bytes.data(), bytes.size()) == size);
    return bytes;
  } catch (const std::runtime_error&) {
    throw OutputError(file + ": cannot be made (does the log fit in memory?)");
  }
}

// HDF5 itself writes the headers of a log without values. It crashes at exit after a full disk, so
// the disk must have room for them, and take a file of the size.
void reserve_headers(const std::string& file, const std::vector<LogEntry>& datasets) {
  std::size_t bytes = kFileBytes, all_bytes = kFileBytes;
  for (const LogEntry& entry : datasets) {
    const std::size_t width = entry.width * sizeof(double);
    bytes += kHeaderBytes + std::min(entry.rows, kSieveBytes / width + 1) * width;
    all_bytes += kHeaderBytes + entry.rows * width;
  }
  const int descriptor = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  int error = descriptor < 0 ? errno : posix_fallocate(descriptor, 0, static_cast<off_t>(bytes));
  if (error == 0 && ftruncate(descriptor, static_cast<off_t>(all_bytes)) != 0) error = errno;
  if (descriptor >= 0) close(descriptor);
  if (error != 0) {
    throw OutputError(file + ": cannot be written (" + std::strerror(error) + ")");
  }
}

// HDF5's usual driver asks for the path of a symbolic link. One in /proc/self/fd has none if
// another run has replaced the log. The driver of stdio does not ask.
hid_t open_to_read(const std::string& file) {
  const Handle stdio(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  require(H5Pset_fapl_stdio(stdio));
  return H5Fopen(file.c_str(), H5F_ACC_RDONLY, stdio);
}

// All datasets except indices. The caller holds hdf5_in_use.
std::vector<LogEntry> list_datasets(const std::string& file) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  try {
    const Handle handle(open_to_read(file), H5Fclose);
    std::vector<LogEntry> entries;
    for (const std::string& track : object_names(handle)) {
      const Handle group(H5Gopen2(handle, track.c_str(), H5P_DEFAULT), H5Gclose);
      for (const std::string& name : object_names(group)) {
        if (is_index_name(name)) continue;  // version 0.2 wrote it
        const Handle data(H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose);
        const Size size = checked_size(data);
        entries.push_back({track, name, read_text(data, "unit"), read_text(data, "description"),
                           size[0], size[1]});
      }
    }
    return entries;
  } catch (const std::runtime_error&) {
    throw std::invalid_argument(file + ": is not a log");
  }
}

// Calls use(data, size) with an open dataset of a log. The caller holds hdf5_in_use.
template <typename Use>
auto with_dataset(const std::string& file, const std::string& dataset, Use&& use) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  try {
    const Handle handle(open_to_read(file), H5Fclose);
    const std::size_t slash = dataset.find('/');
    const std::string track = dataset.substr(0, slash);
    const std::string name = slash == std::string::npos ? "" : dataset.substr(slash + 1);
    check(is_own(handle, track));
    const Handle group(H5Gopen2(handle, track.c_str(), H5P_DEFAULT), H5Gclose);
    check(is_own(group, name));
    const Handle data(H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose);
    return use(data, checked_size(data));
  } catch (const std::runtime_error&) {
    throw std::invalid_argument(file + ": is not a log, or has no " + dataset);
  }
}

std::vector<double> read_rows(hid_t data, std::size_t first, const Size& size) {
  std::vector<double> values(size[0] * size[1]);
  if (values.empty()) return values;
  const Handle all(H5Dget_space(data), H5Sclose);
  const Size begin = {first, 0};
  require(H5Sselect_hyperslab(all, H5S_SELECT_SET, begin.data(), nullptr, size.data(), nullptr));
  const int rank = H5Sget_simple_extent_ndims(all);
  const Handle part(H5Screate_simple(rank, size.data(), nullptr), H5Sclose);
  require(H5Dread(data, H5T_NATIVE_DOUBLE, part, all, H5P_DEFAULT, values.data()));
  return values;
}

// Reads a dataset by parts.
void try_values(const std::string& file, const std::string& dataset) {
  with_dataset(file, dataset, [](hid_t data, const Size& size) {
    for (hsize_t first = 0; first < size[0]; first += kChunkRows) {
      read_rows(data, first, {std::min(kChunkRows, size[0] - first), size[1]});
    }
  });
}

// Sets limits for this process, and makes it end with its parent.
void confine(const std::string& file, pid_t parent) {
  // The parent handles these signals.
  std::signal(SIGINT, SIG_IGN);
  std::signal(SIGHUP, SIG_IGN);
  std::signal(SIGTERM, SIG_IGN);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);  // the parent has already ended

  struct stat about = {};
  stat(file.c_str(), &about);
  const rlim_t seconds = kForeignSeconds + static_cast<rlim_t>(about.st_size) / kBytesASecond;
  // It may also wait for ever, on a machine that is never so busy.
  constexpr rlim_t kBusy = 10;
  std::signal(SIGALRM, SIG_DFL);
  alarm(static_cast<unsigned>(kBusy * seconds));
  const rlimit limit = {seconds, seconds};
  setrlimit(RLIMIT_CPU, &limit);
  const rlimit no_core = {0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  rlim_t pages = 0;
  if (std::ifstream("/proc/self/statm") >> pages) {
    const rlim_t own = pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE));
    const rlimit bytes = {own + kForeignMemory, own + kForeignMemory};
    setrlimit(RLIMIT_AS, &bytes);
  }
}

}  // namespace

void write_hdf5_log(const std::string& file, const std::vector<Track>& tracks, int deflate_level) {
  write_text_file(file, file_image(file, tracks, deflate_level));
}

std::vector<LogEntry> datasets_of(const Track& track, std::size_t rows) {
  std::vector<LogEntry> datasets = {
      {track.name(), kTimeBase, "s", "time of each row of this group", rows, 1}};
  for (std::size_t i = 0; i < track.signals(); ++i) {
    const Signal& signal = track.signal(i);
    datasets.push_back(
        {track.name(), signal.name, signal.unit, signal.description, rows, signal.values.size()});
  }
  return datasets;
}

std::vector<std::uint64_t> lay_out_hdf5_log(const std::string& file,
                                            const std::vector<LogEntry>& datasets) {
  reserve_headers(file, datasets);
  const std::lock_guard lock(hdf5_in_use);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  try {
    const Handle handle(H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
    std::vector<std::uint64_t> places;
    for (auto begin = datasets.begin(); begin != datasets.end();) {
      const auto end = std::find_if(begin, datasets.end(), [&](const LogEntry& entry) {
        return entry.group != begin->group;
      });
      const Handle group = make_group(handle, *begin);
      for (; begin != end; ++begin) places.push_back(write_dataset(group, *begin, nullptr, 0));
    }
    require(H5Fflush(handle, H5F_SCOPE_GLOBAL));
    return places;
  } catch (const std::runtime_error&) {
    throw OutputError(file + ": cannot be written (is it too long for the file system?)");
  }
}

std::string hdf5_version() {
  // A library of another version ends the process by itself.
  return fmt::format("{}.{}.{}", H5_VERS_MAJOR, H5_VERS_MINOR, H5_VERS_RELEASE);
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
  std::vector<std::string> units;
  for (const auto one : std::views::split(unit, std::string_view(", "))) {
    units.emplace_back(one.begin(), one.end());
  }
  return units.size() == width && index >= 1 && index <= width ? units[index - 1] : unit;
}

std::vector<LogEntry> list_hdf5_signals(const std::string& file) {
  const std::lock_guard lock(hdf5_in_use);
  std::vector<LogEntry> entries = list_datasets(file);
  std::erase_if(entries, [](const LogEntry& entry) { return entry.name == kTimeBase; });
  return entries;
}

LoggedSignal read_hdf5_signal(const std::string& file, const std::string& dataset,
                              std::size_t most_rows) {
  const std::lock_guard lock(hdf5_in_use);
  return with_dataset(file, dataset, [&](hid_t data, Size size) {
    size[0] = std::min<hsize_t>(size[0], most_rows);
    return LoggedSignal{size[0], size[1], read_rows(data, 0, size)};
  });
}

std::size_t written_rows(const std::string& file, const std::string& track) {
  const std::lock_guard lock(hdf5_in_use);
  return with_dataset(file, track + "/" + kTimeBase, [](hid_t data, const Size& size) {
    std::size_t least = 0, most = size[0];
    while (least < most) {
      const std::size_t row = least + (most - least) / 2;
      const bool is_written = !std::isnan(read_rows(data, row, {1, 1})[0]);
      (is_written ? least : most) = is_written ? row + 1 : row;
    }
    return least;
  });
}

void check_foreign_log(const std::string& file, bool has_values) {
  const std::lock_guard lock(hdf5_in_use);
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child < 0) throw OutputError(file + ": cannot be read (" + std::strerror(errno) + ")");
  if (child == 0) {
    confine(file, parent);
    try {
      for (const LogEntry& entry : list_datasets(file)) {
        if (has_values) try_values(file, entry.group + "/" + entry.name);
      }
      _exit(0);
    } catch (...) {
      _exit(1);
    }
  }
  int status = -1;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  if (status != 0) throw std::invalid_argument(file + ": is not a log, or one that is damaged");
}

}  // namespace breakwater
