#include <breakwater/render/video_file.h>

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <iterator>
#include <sstream>
#include <vector>

#include <breakwater/record/output_error.h>
#include <breakwater/render/render_error.h>

namespace breakwater {
namespace {

constexpr const char* kProgram = "ffmpeg";
constexpr int kFile = 3;  // the file's descriptor in ffmpeg

// The preset is fast enough to keep up with drawing. On x264's quality scale, 18 looks like the
// original. More than one thread would change the bits of the file, and the other cores draw.
std::vector<std::string> words(const VideoFormat& format) {
  const std::string input =
      fmt::format("{} -v error -xerror -nostdin -y -f rawvideo -pix_fmt bgr0 -s {}x{} -r {} -i - ",
                  kProgram, format.width, format.height, format.fps);
  const std::string colours =
      "-vf scale=out_color_matrix=bt709:out_range=tv:flags=area+accurate_rnd+full_chroma_inp "
      "-pix_fmt yuv420p -colorspace bt709 -color_primaries bt709 -color_trc bt709 -color_range tv "
      "-chroma_sample_location center ";
  std::istringstream options(
      input + colours +
      fmt::format("-c:v libx264 -preset superfast -crf 19 -g {} -threads 1 -movflags +faststart "
                  "-f mp4 file:/proc/self/fd/{}",
                  2 * format.fps, kFile));
  std::vector<std::string> all(std::istream_iterator<std::string>(options), {});
  return all;
}

}  // namespace

VideoFile::VideoFile(const std::filesystem::path& file, const VideoFormat& format)
    : partial_(file),
      frame_bytes_(4 * static_cast<std::size_t>(format.width) *
                   static_cast<std::size_t>(format.height)),
      said_(std::tmpfile(), std::fclose) {
  std::signal(SIGPIPE, SIG_IGN);  // append() then gets an error if ffmpeg ends
  std::vector<std::string> all = words(format);
  std::vector<char*> argv;
  for (std::string& word : all) argv.push_back(word.data());
  argv.push_back(nullptr);
  std::array<int, 2> ends{};
  if (!said_ || pipe2(ends.data(), O_CLOEXEC) != 0) {
    throw OutputError(
        fmt::format("a temporary file or a pipe cannot be made: {}", std::strerror(errno)));
  }
  input_ = ends[1];
  fcntl(input_, F_SETPIPE_SZ, 1 << 20);  // fewer changes of process
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[0], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, fileno(said_.get()), STDERR_FILENO);
  // If this process is killed, ffmpeg must not make a file that is already removed.
  posix_spawn_file_actions_addopen(&actions, kFile, partial_.path().c_str(), O_RDWR, 0);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  // A group of its own: a terminal's Ctrl-C reaches this process alone, which then ends ffmpeg.
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  const int error = posix_spawnp(&ffmpeg_, kProgram, &actions, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[0]);
  if (error == 0) return;
  close(input_);
  throw RenderError(fmt::format("videos need {}: {}", kProgram, std::strerror(error)));
}

VideoFile::~VideoFile() {
  if (ffmpeg_ == 0) return;
  kill(ffmpeg_, SIGKILL);
  wait();
}

// Ends the input. Returns the status of waitpid().
int VideoFile::wait() {
  close(input_);
  int status = 0;
  while (waitpid(ffmpeg_, &status, 0) < 0 && errno == EINTR) continue;
  ffmpeg_ = 0;
  return status;
}

void VideoFile::append(const std::uint8_t* pixels) {
  for (std::size_t left = frame_bytes_; left > 0;) {
    const ssize_t put = write(input_, pixels + (frame_bytes_ - left), left);
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) throw OutputError(partial_.file().string() + ": cannot be written");
    left -= static_cast<std::size_t>(put);
  }
}

void VideoFile::end() {
  if (wait() == 0 && lseek(fileno(said_.get()), 0, SEEK_END) == 0) return;
  std::array<char, 1000> line{};  // the first one has the cause, behind the last colon
  std::rewind(said_.get());
  const bool has_reason = std::fgets(line.data(), line.size(), said_.get()) != nullptr;
  std::string reason = has_reason ? line.data() : fmt::format("{} has ended", kProgram);
  const std::size_t colon = reason.rfind(": ");
  reason = reason.substr(colon == std::string::npos ? 0 : colon + 2);
  throw OutputError(fmt::format("{}: cannot be written ({})", partial_.file().string(),
                                reason.substr(0, reason.find('\n'))));
}

void VideoFile::finish() {
  end();
  partial_.commit();
}

}  // namespace breakwater
