// SPDX-License-Identifier: Apache-2.0
// A driver of OpenNI2 whose camera shows the sequence that RESIGHT_TEST_SEQUENCE names, 10 views a second, again and
// again. As those of real cameras, its images are mirrored until somebody switches that off. It stands in for a device
// in openni_test.sh.
#include <Driver/OniDriverAPI.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <thread>
#include <vector>

#include "resight/io/sequence.hpp"

namespace {

using resight::RgbdFrame;

constexpr int kFramesPerSecond = 10;

int copy_property(const void* value, int size, void* data, int* data_size) {
  if (*data_size < size) return ONI_STATUS_BAD_PARAMETER;
  std::memcpy(data, value, static_cast<std::size_t>(size));
  *data_size = size;
  return ONI_STATUS_OK;
}

class SequenceStream : public oni::driver::StreamBase {
 public:
  SequenceStream(const std::vector<RgbdFrame>& frames, OniSensorType type) : frames_(frames), type_(type) {
    mode_.pixelFormat = is_depth() ? ONI_PIXEL_FORMAT_DEPTH_1_MM : ONI_PIXEL_FORMAT_RGB888;
    mode_.resolutionX = frames.front().camera.width;
    mode_.resolutionY = frames.front().camera.height;
    mode_.fps = kFramesPerSecond;
  }
  ~SequenceStream() override { stop(); }

  OniStatus getProperty(int id, void* data, int* size) override {
    const resight::Camera& camera = frames_.front().camera;
    const auto fov = [](double side_px, double focal_px) {
      return static_cast<float>(2 * std::atan(0.5 * side_px / focal_px));
    };
    const float horizontal = fov(camera.width, camera.fx), vertical = fov(camera.height, camera.fy);
    const int max_value = 10000;
    const OniBool is_mirrored = is_mirrored_ ? TRUE : FALSE;
    const OniCropping uncropped{};
    const auto status = [&](const auto& value) {
      return static_cast<OniStatus>(copy_property(&value, sizeof(value), data, size));
    };
    switch (id) {
      case ONI_STREAM_PROPERTY_VIDEO_MODE:
        return status(mode_);
      case ONI_STREAM_PROPERTY_HORIZONTAL_FOV:
        return status(horizontal);
      case ONI_STREAM_PROPERTY_VERTICAL_FOV:
        return status(vertical);
      case ONI_STREAM_PROPERTY_MAX_VALUE:
        return is_depth() ? status(max_value) : ONI_STATUS_NOT_SUPPORTED;
      case ONI_STREAM_PROPERTY_MIRRORING:
        return status(is_mirrored);
      case ONI_STREAM_PROPERTY_CROPPING:
        return status(uncropped);
      default:
        return ONI_STATUS_NOT_SUPPORTED;
    }
  }
  OniStatus setProperty(int id, const void* data, int /*size*/) override {
    if (id != ONI_STREAM_PROPERTY_MIRRORING) return ONI_STATUS_NOT_SUPPORTED;
    is_mirrored_ = *static_cast<const OniBool*>(data) != FALSE;
    return ONI_STATUS_OK;
  }
  OniBool isPropertySupported(int id) override {
    return id == ONI_STREAM_PROPERTY_VIDEO_MODE || id == ONI_STREAM_PROPERTY_HORIZONTAL_FOV ||
           id == ONI_STREAM_PROPERTY_VERTICAL_FOV || id == ONI_STREAM_PROPERTY_MIRRORING ||
           id == ONI_STREAM_PROPERTY_CROPPING || (id == ONI_STREAM_PROPERTY_MAX_VALUE && is_depth());
  }
  /// What a recorder keeps beside the frames. The file driver shows no frame of a stream without a cropping.
  void notifyAllProperties() override {
    for (const int id :
         {ONI_STREAM_PROPERTY_VIDEO_MODE, ONI_STREAM_PROPERTY_HORIZONTAL_FOV, ONI_STREAM_PROPERTY_VERTICAL_FOV,
          ONI_STREAM_PROPERTY_MAX_VALUE, ONI_STREAM_PROPERTY_MIRRORING, ONI_STREAM_PROPERTY_CROPPING}) {
      char data[64];
      int size = sizeof(data);
      if (getProperty(id, data, &size) == ONI_STATUS_OK) raisePropertyChanged(id, data, size);
    }
  }

  OniStatus start() override {
    is_running_ = true;
    thread_ = std::thread([this] { show_frames(); });
    return ONI_STATUS_OK;
  }
  void stop() override {
    is_running_ = false;
    if (thread_.joinable()) thread_.join();
  }

 private:
  [[nodiscard]] bool is_depth() const { return type_ == ONI_SENSOR_DEPTH; }

  void show_frames() {
    for (int number = 0; is_running_; ++number) {
      show(frames_[static_cast<std::size_t>(number) % frames_.size()], number);
      std::this_thread::sleep_for(std::chrono::milliseconds(1000 / kFramesPerSecond));
    }
  }

  void show(const RgbdFrame& from, int number) {
    OniFrame* frame = getServices().acquireFrame();
    if (frame == nullptr) return;
    frame->frameIndex = number + 1;
    frame->timestamp = static_cast<std::uint64_t>(number + 1) * 1000000 / kFramesPerSecond;
    frame->videoMode = mode_;
    frame->width = mode_.resolutionX;
    frame->height = mode_.resolutionY;
    frame->cropOriginX = frame->cropOriginY = 0;
    frame->croppingEnabled = FALSE;
    frame->sensorType = type_;
    frame->stride = mode_.resolutionX * static_cast<int>(is_depth() ? sizeof(OniDepthPixel) : sizeof(OniRGB888Pixel));
    const auto width = static_cast<std::size_t>(mode_.resolutionX);
    for (std::size_t i = 0; i < from.color.size(); ++i) {
      const std::size_t shown = is_mirrored_ ? i + width - 1 - 2 * (i % width) : i;
      const float z_m = from.depth_m[shown];
      const resight::Rgb8& color = from.color[shown];
      if (is_depth())
        static_cast<OniDepthPixel*>(frame->data)[i] =
            std::isnan(z_m) ? OniDepthPixel{0} : static_cast<OniDepthPixel>(std::lround(1000 * z_m));
      else
        static_cast<OniRGB888Pixel*>(frame->data)[i] = {color.r, color.g, color.b};
    }
    raiseNewFrame(frame);
    getServices().releaseFrame(frame);
  }

  const std::vector<RgbdFrame>& frames_;
  OniSensorType type_;
  OniVideoMode mode_{};
  std::atomic<bool> is_running_ = false;
  std::atomic<bool> is_mirrored_ = true;
  std::thread thread_;
};

class SequenceDevice : public oni::driver::DeviceBase {
 public:
  explicit SequenceDevice(const std::vector<RgbdFrame>& frames) : frames_(frames) {
    for (const OniSensorType type : {ONI_SENSOR_DEPTH, ONI_SENSOR_COLOR}) {
      OniVideoMode& mode = modes_[type == ONI_SENSOR_DEPTH ? 0 : 1];
      mode.pixelFormat = type == ONI_SENSOR_DEPTH ? ONI_PIXEL_FORMAT_DEPTH_1_MM : ONI_PIXEL_FORMAT_RGB888;
      mode.resolutionX = frames.front().camera.width;
      mode.resolutionY = frames.front().camera.height;
      mode.fps = kFramesPerSecond;
      sensors_[type == ONI_SENSOR_DEPTH ? 0 : 1] = {type, 1, &mode};
    }
  }
  OniStatus getSensorInfoList(OniSensorInfo** sensors, int* num_sensors) override {
    *sensors = sensors_;
    *num_sensors = 2;
    return ONI_STATUS_OK;
  }
  OniBool isImageRegistrationModeSupported(OniImageRegistrationMode mode) override {
    return mode == ONI_IMAGE_REGISTRATION_OFF || std::getenv("RESIGHT_TEST_UNREGISTERED") == nullptr;
  }
  OniBool isPropertySupported(int id) override { return id == ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION; }
  OniStatus getProperty(int id, void* data, int* size) override {
    if (id != ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION) return ONI_STATUS_NOT_SUPPORTED;
    return static_cast<OniStatus>(copy_property(&registration_, sizeof(registration_), data, size));
  }
  OniStatus setProperty(int id, const void* data, int size) override {
    if (id != ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION || size != sizeof(registration_)) return ONI_STATUS_NOT_SUPPORTED;
    std::memcpy(&registration_, data, sizeof(registration_));
    return ONI_STATUS_OK;
  }
  oni::driver::StreamBase* createStream(OniSensorType type) override { return new SequenceStream(frames_, type); }
  void destroyStream(oni::driver::StreamBase* stream) override { delete stream; }

 private:
  const std::vector<RgbdFrame>& frames_;
  OniImageRegistrationMode registration_ = ONI_IMAGE_REGISTRATION_OFF;
  OniVideoMode modes_[2] = {};
  OniSensorInfo sensors_[2] = {};
};

class SequenceDriver : public oni::driver::DriverBase {
 public:
  explicit SequenceDriver(OniDriverServices* services) : DriverBase(services) {}
  OniStatus initialize(oni::driver::DeviceConnectedCallback connected,
                       oni::driver::DeviceDisconnectedCallback disconnected,
                       oni::driver::DeviceStateChangedCallback changed, void* cookie) override {
    DriverBase::initialize(connected, disconnected, changed, cookie);
    const char* folder = std::getenv("RESIGHT_TEST_SEQUENCE");
    if (folder == nullptr) return ONI_STATUS_OK;
    const auto sequence = resight::open_sequence(folder);
    if (!sequence.ok()) return ONI_STATUS_ERROR;
    for (int v = 0; v < (*sequence)->num_views(); ++v) frames_.push_back((*sequence)->read_view(v).value());
    std::strcpy(info_.uri, "test/sequence");
    std::strcpy(info_.vendor, "resight");
    std::strcpy(info_.name, "sequence");
    deviceConnected(&info_);
    return ONI_STATUS_OK;
  }
  oni::driver::DeviceBase* deviceOpen(const char* /*uri*/, const char* /*mode*/) override {
    return new SequenceDevice(frames_);
  }
  void deviceClose(oni::driver::DeviceBase* device) override { delete device; }
  void shutdown() override {}

 private:
  OniDeviceInfo info_{};
  std::vector<RgbdFrame> frames_;
};

}  // namespace

// The macro below uses them, but no installed header defines them.
#define XN_NEW(type, ...) new type(__VA_ARGS__)
#define XN_DELETE(pointer) delete pointer
ONI_EXPORT_DRIVER(SequenceDriver)
