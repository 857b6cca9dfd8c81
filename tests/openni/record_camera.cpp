// SPDX-License-Identifier: Apache-2.0
// Records the first camera of OpenNI2 into a file of OpenNI2, for openni_test.sh.
//   resight_record_camera FILE.oni NUM_FRAMES
#include <OpenNI.h>

#include <cstdio>
#include <cstdlib>
#include <initializer_list>

namespace {

void require(bool ok, const char* what) {
  if (ok) return;
  std::fprintf(stderr, "%s: %s\n", what, openni::OpenNI::getExtendedError());
  std::exit(1);
}

void record(const char* path, int num_frames) {
  openni::Device device;
  require(device.open(openni::ANY_DEVICE) == openni::STATUS_OK, "camera");
  openni::VideoStream depth, color;
  require(depth.create(device, openni::SENSOR_DEPTH) == openni::STATUS_OK, "depth");
  require(color.create(device, openni::SENSOR_COLOR) == openni::STATUS_OK, "colour");
  openni::Recorder recorder;
  require(recorder.create(path) == openni::STATUS_OK, path);
  require(recorder.attach(depth) == openni::STATUS_OK && recorder.attach(color) == openni::STATUS_OK, "streams");
  require(depth.start() == openni::STATUS_OK && color.start() == openni::STATUS_OK, "start");
  require(recorder.start() == openni::STATUS_OK, "recording");
  openni::VideoFrameRef frame;
  for (int f = 0; f < num_frames; ++f)
    for (openni::VideoStream* stream : {&depth, &color})
      require(stream->readFrame(&frame) == openni::STATUS_OK, "frame");
  frame.release();
  recorder.stop();
  recorder.destroy();
  for (openni::VideoStream* stream : {&depth, &color}) stream->destroy();
  device.close();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  require(openni::OpenNI::initialize() == openni::STATUS_OK, "OpenNI2");
  record(argv[1], std::atoi(argv[2]));
  openni::OpenNI::shutdown();
  return 0;
}
