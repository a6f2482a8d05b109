#include <breakwater/render/video_file.h>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
}

#include <array>
#include <bit>
#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>

#include <breakwater/record/loaded_library.h>
#include <breakwater/record/output_error.h>
#include <breakwater/render/render_error.h>

namespace breakwater {
namespace {

struct NoFfmpeg : RenderError {
  explicit NoFfmpeg(const std::string& reason)
      : RenderError("videos need FFmpeg's libraries: " + reason) {}
};

// It links FFmpeg's other libraries, and with them 130 more.
const LoadedLibrary& libavformat() {
  static const LoadedLibrary library("libavformat.so." AV_STRINGIFY(LIBAVFORMAT_VERSION_MAJOR),
                                     "libavformat" AV_STRINGIFY(LIBAVFORMAT_VERSION_MAJOR));
  return library;
}

// clang-format off
#define X(name) BREAKWATER_LOADED(libavformat, NoFfmpeg, name)
X(av_dict_free) X(av_dict_set) X(av_frame_alloc) X(av_frame_free) X(av_interleaved_write_frame)
X(av_log_set_level) X(av_opt_set) X(av_packet_alloc) X(av_packet_free) X(av_packet_rescale_ts)
X(av_strerror) X(av_write_trailer) X(avcodec_alloc_context3) X(avcodec_find_encoder_by_name)
X(avcodec_free_context) X(avcodec_open2) X(avcodec_parameters_from_context)
X(avcodec_receive_packet) X(avcodec_send_frame) X(avformat_alloc_output_context2)
X(avformat_free_context) X(avformat_new_stream) X(avformat_write_header) X(avio_closep)
X(avio_flush) X(avio_open)
#undef X
    // clang-format on

    // Fast enough to keep up with drawing. On x264's quality scale, 18 looks like the original.
    constexpr const char* kPreset = "superfast";
constexpr const char* kQuality = "19";
// More than one would change the bits of the file. The other cores are busy with drawing.
constexpr int kThreads = 1;

struct Planes {
  std::array<std::uint8_t*, 4> data{};
  std::array<int, 4> stride{};
};

Planes planes(std::uint8_t* frame, int width, int height) {
  const std::ptrdiff_t luma = static_cast<std::ptrdiff_t>(width) * height;
  return {{frame, frame + luma, frame + luma + luma / 4, nullptr},
          {width, width / 2, width / 2, 0}};
}

}  // namespace

struct VideoFile::Streams {
  AVFormatContext* container = nullptr;
  AVCodecContext* encoder = nullptr;
  AVStream* stream = nullptr;
  AVFrame* frame = nullptr;
  AVPacket* packet = nullptr;

  Streams() { av_log_set_level(AV_LOG_QUIET); }  // throws if the libraries are not there
  Streams(const Streams&) = delete;
  Streams& operator=(const Streams&) = delete;
  ~Streams() {
    av_packet_free(&packet);
    av_frame_free(&frame);
    avcodec_free_context(&encoder);
    if (container != nullptr) {
      avio_closep(&container->pb);
      avformat_free_context(container);
    }
  }
};

VideoFile::VideoFile(const std::filesystem::path& file, const VideoFormat& format)
    : partial_(file), format_(format), streams_(std::make_unique<Streams>()) {
  Streams& s = *streams_;
  const AVCodec* codec = avcodec_find_encoder_by_name(format.encoder.c_str());
  if (codec == nullptr) {
    throw RenderError("video: FFmpeg's libraries have no encoder " + format.encoder);
  }
  s.encoder = avcodec_alloc_context3(codec);
  s.frame = av_frame_alloc();
  s.packet = av_packet_alloc();
  // The muxer needs the name: it opens the file again to put the index in front. Without "file:" a
  // name such as "2N:5N.mp4" would be the address of a protocol.
  const std::string url = "file:" + std::filesystem::absolute(partial_.path()).string();
  avformat_alloc_output_context2(&s.container, nullptr, "mp4", url.c_str());
  if (s.encoder == nullptr || s.frame == nullptr || s.packet == nullptr || s.container == nullptr) {
    throw RenderError("video: no memory for the encoder");
  }
  AVCodecContext& e = *s.encoder;
  e.width = format.width;
  e.height = format.height;
  e.pix_fmt = AV_PIX_FMT_YUV420P;
  e.time_base = {1, format.fps};
  e.framerate = {format.fps, 1};
  e.gop_size = 2 * format.fps;
  e.thread_count = kThreads;
  e.color_range = AVCOL_RANGE_MPEG;
  e.colorspace = AVCOL_SPC_BT709;
  e.color_primaries = AVCOL_PRI_BT709;
  e.color_trc = AVCOL_TRC_BT709;
  e.chroma_sample_location = AVCHROMA_LOC_CENTER;
  e.flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
  av_opt_set(e.priv_data, "preset", kPreset, 0);
  av_opt_set(e.priv_data, "crf", kQuality, 0);
  if (avcodec_open2(&e, codec, nullptr) < 0) {
    throw RenderError("video: the encoder " + format.encoder + " does not take " +
                      std::to_string(format.width) + "x" + std::to_string(format.height) + " at " +
                      std::to_string(format.fps) + " frames/s");
  }
  s.stream = avformat_new_stream(s.container, nullptr);
  if (s.stream == nullptr) throw RenderError("video: no memory for the encoder");
  s.stream->time_base = e.time_base;
  s.stream->avg_frame_rate = e.framerate;
  if (avcodec_parameters_from_context(s.stream->codecpar, &e) < 0) {
    throw RenderError("video: no memory for the encoder");
  }
  s.frame->format = e.pix_fmt;
  s.frame->width = e.width;
  s.frame->height = e.height;

  check(avio_open(&s.container->pb, url.c_str(), AVIO_FLAG_WRITE));
  AVDictionary* options = nullptr;
  av_dict_set(&options, "movflags", "+faststart", 0);
  const int status = avformat_write_header(s.container, &options);
  av_dict_free(&options);
  check(status);
}

VideoFile::~VideoFile() = default;

void VideoFile::check(int status) const {
  if (status >= 0) return;
  std::array<char, AV_ERROR_MAX_STRING_SIZE> reason{};
  av_strerror(status, reason.data(), reason.size());
  throw OutputError(partial_.file().string() + ": cannot be written (" + reason.data() + ")");
}

// A null frame asks for the remaining frames of the encoder.
void VideoFile::encode(const void* frame) {
  Streams& s = *streams_;
  check(avcodec_send_frame(s.encoder, static_cast<const AVFrame*>(frame)));
  for (;;) {
    const int status = avcodec_receive_packet(s.encoder, s.packet);
    if (status == AVERROR(EAGAIN) || status == AVERROR_EOF) return;
    check(status);
    s.packet->duration = 1;
    av_packet_rescale_ts(s.packet, s.encoder->time_base, s.stream->time_base);
    s.packet->stream_index = s.stream->index;
    check(av_interleaved_write_frame(s.container, s.packet));
  }
}

void VideoFile::append(const std::uint8_t* frame) {
  AVFrame& f = *streams_->frame;
  // The encoder only reads, and makes its own copies.
  const Planes source = planes(const_cast<std::uint8_t*>(frame), format_.width, format_.height);
  for (std::size_t i = 0; i < 3; ++i) {
    f.data[i] = source.data[i];
    f.linesize[i] = source.stride[i];
  }
  f.pts = frames_++;
  encode(&f);
}

void VideoFile::note(const std::string& comment) {
  av_dict_set(&streams_->container->metadata, "comment", comment.c_str(), 0);
}

void VideoFile::finish() {
  Streams& s = *streams_;
  encode(nullptr);
  check(av_write_trailer(s.container));
  avio_flush(s.container->pb);
  check(s.container->pb->error);
  check(avio_closep(&s.container->pb));
  partial_.commit();
}

namespace {

static_assert(std::endian::native == std::endian::little, "a pixel's blue is its lowest byte");

// The compiler can vectorise these loops: sixteen bits are enough, and the arrays do not overlap.

void split(const std::uint8_t* __restrict pixels, std::uint16_t* __restrict blue,
           std::uint16_t* __restrict green, std::uint16_t* __restrict red, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    std::uint32_t p = 0;
    std::memcpy(&p, pixels + 4 * i, sizeof(p));
    blue[i] = static_cast<std::uint16_t>(p & 255U);
    green[i] = static_cast<std::uint16_t>((p >> 8U) & 255U);
    red[i] = static_cast<std::uint16_t>((p >> 16U) & 255U);
  }
}

void to_luma(const std::uint16_t* __restrict blue, const std::uint16_t* __restrict green,
             const std::uint16_t* __restrict red, std::uint8_t* __restrict luma,
             std::size_t count) {
  constexpr int kBlack = 16 * 256 + 128;
  for (std::size_t i = 0; i < count; ++i) {
    const auto y = static_cast<std::uint16_t>(16 * blue[i] + 157 * green[i] + 47 * red[i] + kBlack);
    luma[i] = static_cast<std::uint8_t>(y >> 8U);
  }
}

// Averages blocks of two by two pixels.
void to_means(const std::uint16_t* __restrict upper, const std::uint16_t* __restrict lower,
              std::uint16_t* __restrict means, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    std::uint32_t above = 0;
    std::uint32_t below = 0;
    std::memcpy(&above, upper + 2 * i, sizeof(above));
    std::memcpy(&below, lower + 2 * i, sizeof(below));
    const std::uint32_t sums = above + below;  // two sums of sixteen bits
    means[i] = static_cast<std::uint16_t>(((sums & 0xFFFFU) + (sums >> 16U) + 2U) >> 2U);
  }
}

void to_chroma(const std::uint16_t* __restrict blue, const std::uint16_t* __restrict green,
               const std::uint16_t* __restrict red, std::uint8_t* __restrict cb,
               std::uint8_t* __restrict cr, std::size_t count) {
  const auto part = [](int sum) {
    return static_cast<std::uint8_t>(128 + (static_cast<std::int16_t>(sum + 128) >> 8));
  };
  for (std::size_t i = 0; i < count; ++i) {
    cb[i] = part(112 * blue[i] - 86 * green[i] - 26 * red[i]);
    cr[i] = part(112 * red[i] - 102 * green[i] - 10 * blue[i]);
  }
}

}  // namespace

std::size_t yuv420p_bytes(int width, int height) {
  return static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3 / 2;
}

ColourConverter::ColourConverter(int width, int height)
    : width_(static_cast<std::size_t>(width)),
      height_(static_cast<std::size_t>(height)),
      upper_(width_),
      lower_(width_),
      means_(width_ / 2) {}

void ColourConverter::convert(const std::uint8_t* pixels, std::uint8_t* frame) {
  const std::size_t half = width_ / 2;
  std::uint8_t* const cb = frame + width_ * height_;
  std::uint8_t* const cr = cb + half * (height_ / 2);
  for (std::size_t y = 0; y + 1 < height_; y += 2) {
    std::size_t at = y;
    for (Row* row : {&upper_, &lower_}) {
      split(pixels + 4 * width_ * at, row->blue.data(), row->green.data(), row->red.data(), width_);
      to_luma(row->blue.data(), row->green.data(), row->red.data(), frame + width_ * at, width_);
      ++at;
    }
    to_means(upper_.blue.data(), lower_.blue.data(), means_.blue.data(), half);
    to_means(upper_.green.data(), lower_.green.data(), means_.green.data(), half);
    to_means(upper_.red.data(), lower_.red.data(), means_.red.data(), half);
    to_chroma(means_.blue.data(), means_.green.data(), means_.red.data(), cb + half * (y / 2),
              cr + half * (y / 2), half);
  }
}

}  // namespace breakwater
