// SPDX-License-Identifier: Apache-2.0
#include <pcl/common/point_tests.h>
#include <pcl/pcl_config.h>

// PCL 1.13 as released drops the model points whose normals ARE finite (addModel() of hv_go.hpp), that is, all of them,
// and then accepts hypotheses at random. The macro inverts its single test, because a working peer is the better
// comparison.
#if PCL_VERSION_COMPARE(==, 1, 13, 0)
#define isNormalFinite(normal) !(isNormalFinite)(normal)
#endif
#include <pcl/recognition/hv/hv_go.h>
#undef isNormalFinite

#include <algorithm>

#include "../cpu_clock.hpp"
#include "pcl_clouds.hpp"

namespace resight::bench::pcl_peers {

Timed<std::vector<std::uint8_t>> verify_hypotheses(OrganizedPoints view, std::span<const std::vector<float>> models,
                                                   const VerifyOptions& options) {
  const XyzCloud::Ptr scene = make_cloud(view);
  std::vector<XyzCloud::ConstPtr> clouds;
  for (const std::vector<float>& model : models) clouds.push_back(make_cloud(Points(model)));
  std::vector<bool> mask;
  const CpuClock clock;
  pcl::GlobalHypothesesVerification<pcl::PointXYZ, pcl::PointXYZ> verification;
  verification.setResolution(options.resolution_m);
  verification.setInlierThreshold(options.inlier_distance_m);
  verification.setOcclusionThreshold(options.occlusion_margin_m);
  verification.setRadiusClutter(options.clutter_radius_m);
  verification.setClutterRegularizer(options.clutter_regularizer);
  verification.setRegularizer(options.regularizer);
  verification.setRadiusNormals(options.normal_radius_m);
  verification.setDetectClutter(true);
  verification.setSceneCloud(scene);
  verification.setOcclusionCloud(scene);
  verification.addModels(clouds, true);
  verification.verify();
  verification.getMask(mask);
  const double cpu_s = clock.elapsed_s();
  std::vector<std::uint8_t> accepted(mask.size());
  std::copy(mask.begin(), mask.end(), accepted.begin());
  return {std::move(accepted), cpu_s};
}

}  // namespace resight::bench::pcl_peers
