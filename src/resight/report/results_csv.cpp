// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <iterator>

#include "resight/report/internal/results_text.hpp"

namespace resight {

void report::put_detections_csv(const ReportRun& run, const ModelLibrary& library, const TextSink& sink) {
  sink("scene_id,im_id,obj_id,score,R,t,time\n");
  for (const ViewRecord& view : run.views) {
    std::string csv;
    const double time_s = view.update.times.total_wall_s();
    const Rigid3 camera_from_world = view.update.world_from_camera.inverse();
    for (const Detection& detection : view.update.detections) {
      const Rigid3 pose = camera_from_world * detection.world_from_object;
      const Eigen::Matrix3d& r = pose.rotation;
      const Eigen::Vector3d t_mm = pose.translation * 1000.0;
      fmt::format_to(std::back_inserter(csv), "{},{},{},{},{} {} {} {} {} {} {} {} {},{} {} {},{}\n", view.scene_id,
                     view.image_id, library.object(detection.object).bop_id, detection.score, r(0, 0), r(0, 1), r(0, 2),
                     r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1), r(2, 2), t_mm.x(), t_mm.y(), t_mm.z(), time_s);
    }
    sink(csv);
  }
}

}  // namespace resight
