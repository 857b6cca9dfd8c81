// SPDX-License-Identifier: Apache-2.0
#pragma once
// Three objects, a scene with its views, and what verify_hypotheses() makes of it.
#include <vector>

#include "resight/verification/testing/analytic_scene.hpp"

namespace resight::analytic {

inline const Eigen::Vector3d kZ = Eigen::Vector3d::UnitZ();

inline Solid make_box() { return {Shape::kBox, {0.10, 0.07, 0.14}, checks({200, 40, 40}, {230, 220, 200}, 0.03), {}}; }
inline Solid make_cylinder() {
  return {Shape::kCylinder, {0.08, 0.08, 0.12}, checks({40, 60, 190}, {220, 220, 60}, 0.025), {}};
}
inline Solid make_sphere() { return {Shape::kSphere, {0.09, 0.09, 0.09}, plain({60, 170, 70}), {}}; }

enum Object { kBox, kCylinder, kSphere };

inline ModelLibrary make_library() {
  ModelLibrary library;
  library.objects = {make_model("box", make_box()), make_model("cylinder", make_cylinder()),
                     make_model("sphere", make_sphere())};
  return library;
}

inline Solid placed(Solid solid, const Rigid3& pose) {
  solid.world_from_object = pose;
  return solid;
}

// A scene with its views and reconstruction.
struct Fixture {
  Fixture(const World& world, const std::vector<Rigid3>& cameras)
      : views(render_all(world, cameras)), scene(merge(views)) {}
  VerifyResult verify(const std::vector<Hypothesis>& hypotheses, const ModelLibrary& library,
                      const VerifyOptions& options = {}, const std::vector<std::uint8_t>& present = {}) const {
    const std::vector<VerificationView> refs = references(views);
    return verify_hypotheses(hypotheses, library, scene, refs, present, options);
  }
  /// As a camera without chromaticity sees it.
  void turn_grey() {
    for (PreparedView& view : views) {
      for (Rgb8& c : view.frame.color.data()) c = to_grey(c);
      view.is_grey = true;
    }
    scene = merge(views);
  }
  std::vector<PreparedView> views;
  PointCloud scene;
};

inline std::vector<int> accepted(const VerifyResult& result) {
  std::vector<int> indices;
  for (std::size_t i = 0; i < result.evidence.size(); ++i)
    if (result.evidence[i].accepted) indices.push_back(static_cast<int>(i));
  return indices;
}

inline World one_box() { return {.solids = {placed(make_box(), on_table(0, 0, 0.07, 0.4))}}; }

}  // namespace resight::analytic
