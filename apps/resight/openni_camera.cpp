// SPDX-License-Identifier: Apache-2.0
#include "openni_camera.hpp"

#include "commands.hpp"
#include "resight/core/input_file.hpp"
#include "resight/io/intrinsics.hpp"
#include "resight/sensor/rectify.hpp"

#ifdef RESIGHT_HAS_OPENNI
#include <OpenNI.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <limits>
#endif

namespace resight::app {

#ifdef RESIGHT_HAS_OPENNI
namespace {

constexpr std::int64_t kMaxPairGap_us = 20'000;  // As in recordings.

[[noreturn]] void fail_openni(const std::string& what) {
  std::string why = openni::OpenNI::getExtendedError();
  std::ranges::replace(why, '\n', ' ');
  while (why.ends_with(' ')) why.pop_back();
  throw InputError("openni2: " + what + (why.empty() ? "" : ": " + why));
}

void require_ok(openni::Status status, const std::string& what) {
  if (status != openni::STATUS_OK) fail_openni(what);
}

/// Initialises OpenNI once, for as long as a camera is open.
struct OpenniSession {
  OpenniSession() { require_ok(openni::OpenNI::initialize(), "cannot start"); }
  ~OpenniSession() { openni::OpenNI::shutdown(); }
  OpenniSession(const OpenniSession&) = delete;
  OpenniSession& operator=(const OpenniSession&) = delete;
};

// Images that are mirrored are turned back.
Image<Rgb8> to_color_image(const openni::VideoFrameRef& frame, bool is_mirrored) {
  const bool is_grey = frame.getVideoMode().getPixelFormat() == openni::PIXEL_FORMAT_GRAY8;
  if (!is_grey && frame.getVideoMode().getPixelFormat() != openni::PIXEL_FORMAT_RGB888)
    throw InputError("openni2: the colours are neither RGB nor grey");
  Image<Rgb8> color(frame.getWidth(), frame.getHeight());
  for (int v = 0; v < color.height(); ++v) {
    const auto* row =
        static_cast<const std::uint8_t*>(frame.getData()) + static_cast<std::ptrdiff_t>(v) * frame.getStrideInBytes();
    for (int u = 0; u < color.width(); ++u)
      color(is_mirrored ? color.width() - 1 - u : u, v) =
          is_grey ? Rgb8{row[u], row[u], row[u]} : Rgb8{row[3 * u], row[3 * u + 1], row[3 * u + 2]};
  }
  return color;
}

Image<float> to_depth_image(const openni::VideoFrameRef& frame, bool is_mirrored) {
  const double unit_m = frame.getVideoMode().getPixelFormat() == openni::PIXEL_FORMAT_DEPTH_100_UM ? 1e-4 : 1e-3;
  Image<float> depth_m(frame.getWidth(), frame.getHeight(), std::numeric_limits<float>::quiet_NaN());
  for (int v = 0; v < depth_m.height(); ++v) {
    const auto* row = reinterpret_cast<const openni::DepthPixel*>(
        static_cast<const std::uint8_t*>(frame.getData()) + static_cast<std::ptrdiff_t>(v) * frame.getStrideInBytes());
    for (int u = 0; u < depth_m.width(); ++u)
      if (row[u] != 0) depth_m(is_mirrored ? depth_m.width() - 1 - u : u, v) = static_cast<float>(row[u] * unit_m);
  }
  return depth_m;
}

/// A URI that is a path names a recording. OpenNI2 would wait for a pipe without an end.
void check_recording(const std::string& uri) {
  std::error_code ignored;
  if (std::filesystem::exists(uri, ignored)) value_or_throw(InputFile::open(uri));
}

/// A stream and its frame that waits for its partner.
struct CameraStream {
  openni::VideoStream stream;
  openni::VideoFrameRef frame;
  int last_index = -1;                               ///< Of the last one.
  int num_frames = std::numeric_limits<int>::max();  ///< Of a recording: their indices are 1 to this.
  [[nodiscard]] bool has_ended() const { return !frame.isValid() && last_index >= num_frames; }
};

}  // namespace

struct OpenniCamera::Impl {
  OpenniSession session;
  openni::Device device;
  CameraStream color, depth;
  Camera camera;
  LensDistortion lens;
  int num_skipped = 0;
  int num_views = 0;
  std::vector<std::string> notes;

  void open_stream(CameraStream& opened, openni::SensorType type, const char* what);
  void register_depth();
  void tell_registration();
  void play_once();
  void find_camera(const OpenCameraOptions& options);
  bool read(CameraStream& from, int timeout_ms);
  FollowedView make_view();
};

void OpenniCamera::Impl::open_stream(CameraStream& opened, openni::SensorType type, const char* what) {
  require_ok(opened.stream.create(device, type), std::string("has no ") + what + " stream");
  // Drivers mirror by default. A recording stays as it was recorded, whatever is set.
  if (!device.isFile()) opened.stream.setMirroringEnabled(false);
  require_ok(opened.stream.start(), std::string("the ") + what + " stream cannot be started");
}

void OpenniCamera::Impl::register_depth() {
  if (device.isImageRegistrationModeSupported(openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR))
    device.setImageRegistrationMode(openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR);
  device.setDepthColorSyncEnabled(true);
}

void OpenniCamera::Impl::tell_registration() {
  if (device.getImageRegistrationMode() == openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR) return;
  if (device.isFile())
    notes.emplace_back("the recording does not tell whether its depth is registered to its colours");
  else
    print_warning("openni2: the camera does not register its depth to its colours: objects may get a wrong surface");
}

void OpenniCamera::Impl::play_once() {
  openni::PlaybackControl* playback = device.getPlaybackControl();
  if (playback == nullptr) return;
  require_ok(playback->setRepeatEnabled(false), "the recording cannot be played once");
  for (CameraStream* played : {&depth, &color}) played->num_frames = playback->getNumberOfFrames(played->stream);
}

void OpenniCamera::Impl::find_camera(const OpenCameraOptions& options) {
  const openni::VideoMode mode = depth.stream.getVideoMode();
  const int width = mode.getResolutionX();
  const int height = mode.getResolutionY();
  const openni::VideoMode color_mode = color.stream.getVideoMode();
  if (color_mode.getResolutionX() != width || color_mode.getResolutionY() != height)
    throw InputError(fmt::format("openni2: colour has {}x{} px and depth {}x{}; they must be of one size",
                                 color_mode.getResolutionX(), color_mode.getResolutionY(), width, height));
  if (!options.intrinsics.empty()) {
    const CalibratedCamera given = value_or_throw(read_intrinsics(options.intrinsics, width, height));
    camera = given.camera;
    lens = given.lens;
    notes = {"intrinsics of --intrinsics"};
  } else {
    const double focal_px = 0.5 * width / std::tan(0.5 * depth.stream.getHorizontalFieldOfView());
    camera = {width, height, focal_px, focal_px, 0.5 * (width - 1), 0.5 * (height - 1)};
    notes = {fmt::format("focal length {:.1f} px from the field of view of the depth (--intrinsics)", focal_px)};
  }
  if (!camera.is_valid()) throw InputError("openni2: the camera tells no field of view: give --intrinsics");
  if (options.sensor != nullptr) camera.noise = options.sensor->noise;
}

bool OpenniCamera::Impl::read(CameraStream& from, int timeout_ms) {
  openni::VideoStream* stream = &from.stream;
  int ready = -1;
  const openni::Status status = openni::OpenNI::waitForAnyStream(&stream, 1, &ready, timeout_ms);
  if (status == openni::STATUS_TIME_OUT) return false;
  require_ok(status, "the camera is gone");
  require_ok(from.stream.readFrame(&from.frame), "a frame cannot be read");
  const int index = from.frame.getFrameIndex();
  if (&from == &depth && from.last_index >= 0) num_skipped += std::max(0, index - from.last_index - 1);
  from.last_index = index;
  return true;
}

FollowedView OpenniCamera::Impl::make_view() {
  FollowedView view;
  view.frame = {.name = fmt::format("{:06d}", depth.frame.getFrameIndex()),
                .camera = camera,
                .color = to_color_image(color.frame, color.stream.getMirroringEnabled()),
                .depth_m = to_depth_image(depth.frame, depth.stream.getMirroringEnabled()),
                .world_from_camera = Rigid3()};
  view.image_id = num_views++;
  color.frame.release();
  depth.frame.release();
  value_or_throw(check_frame(view.frame));
  if (!lens.is_none()) {
    view.frame.color = undistort_color(view.frame.color, camera, lens);
    view.frame.depth_m = undistort_depth(view.frame.depth_m, camera, lens);
  }
  return view;
}

OpenniCamera::OpenniCamera(const OpenCameraOptions& options) : impl_(std::make_unique<Impl>()) {
  check_recording(options.uri);
  const std::string what = options.uri.empty() ? "no camera was found" : options.uri + " cannot be opened";
  require_ok(impl_->device.open(options.uri.empty() ? openni::ANY_DEVICE : options.uri.c_str()), what);
  impl_->register_depth();
  impl_->open_stream(impl_->depth, openni::SENSOR_DEPTH, "depth");
  impl_->open_stream(impl_->color, openni::SENSOR_COLOR, "colour");
  impl_->play_once();
  impl_->find_camera(options);
  impl_->tell_registration();
}

OpenniCamera::~OpenniCamera() {
  for (CameraStream* stream : {&impl_->color, &impl_->depth}) {
    stream->frame.release();
    stream->stream.stop();
    stream->stream.destroy();
  }
  impl_->device.close();
}

std::optional<FollowedView> OpenniCamera::take(double timeout_s) {
  const int timeout_ms = static_cast<int>(1000 * timeout_s);
  for (;;) {
    for (CameraStream* stream : {&impl_->depth, &impl_->color})
      if (!stream->frame.isValid() && !impl_->read(*stream, timeout_ms)) return std::nullopt;
    if (!impl_->depth.frame.isValid() || !impl_->color.frame.isValid())
      throw InputError("openni2: the camera gave a frame without an image");
    const auto depth_us = static_cast<std::int64_t>(impl_->depth.frame.getTimestamp());
    const auto color_us = static_cast<std::int64_t>(impl_->color.frame.getTimestamp());
    if (std::abs(depth_us - color_us) <= kMaxPairGap_us) return impl_->make_view();
    (depth_us < color_us ? impl_->depth : impl_->color).frame.release();  // The older one has no partner.
  }
}

bool OpenniCamera::has_ended() const { return impl_->depth.has_ended() || impl_->color.has_ended(); }

int OpenniCamera::num_skipped() const { return impl_->num_skipped; }

std::vector<std::string> OpenniCamera::notes() const { return impl_->notes; }

#else

struct OpenniCamera::Impl {};

OpenniCamera::OpenniCamera(const OpenCameraOptions& /*options*/) {
  throw InputError("--camera: this program was built without OpenNI2 (Debian: libopenni2-dev)");
}
OpenniCamera::~OpenniCamera() = default;
std::optional<FollowedView> OpenniCamera::take(double /*timeout_s*/) { return std::nullopt; }
bool OpenniCamera::has_ended() const { return false; }
int OpenniCamera::num_skipped() const { return 0; }
std::vector<std::string> OpenniCamera::notes() const { return {}; }

#endif

}  // namespace resight::app
