// SPDX-License-Identifier: Apache-2.0
#include "resight/registration/bias_adjustment.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <optional>

#include "resight/core/parallel.hpp"
#include "resight/core/statistics.hpp"
#include "resight/registration/point_to_plane.hpp"
#include "resight/registration/twist.hpp"

namespace resight {
namespace {

constexpr int kPairRow = 13;  // The motions of two views, and the bias.

constexpr double kPriorSigma_per_m = 0.1;      // So large a bias is none. Views that do not overlap show nothing more.
constexpr std::size_t kMaxBiasSamples = 2500;  // Per view.
constexpr double kMinNormalCosine = 0.82;      // As AlignViewOptions::max_normal_angle_rad.
constexpr double kInformationPerPair = 0.25;   // As AlignViewOptions::information_per_pair.
constexpr double kUnknownSigma_m = 0.002;      // What the noise does not explain: edges of pixels, interpolation.
constexpr double kMotionSigma_m = 0.01;        // Of given motions between the views, as CorrectCameraOptions.
constexpr double kMotionSigma_rad = 0.0175;
constexpr double kGateSigmas = 3;
// Largest distances of pairs, step by step: the poses are found first, the bias with the last ones.
constexpr std::array<double, 8> kGates_m = {0.04, 0.04, 0.02, 0.02, 0.012, 0.012, 0.012, 0.012};
constexpr int kPartSteps = 3;  // At the last gate.

double radius_of(const Eigen::Vector3d& point) { return std::hypot(point.x(), point.y()) / point.z(); }

Eigen::Vector3d without_bias(const Eigen::Vector3d& measured, double bias_per_m) {
  return measured / std::max(0.1, 1 - bias_per_m * measured.z());
}

// Motions are a rotation about the camera and a shift, both in world axes.
Twist motion_between(const Rigid3& from, const Rigid3& to) {
  return to_twist({to.rotation * from.rotation.transpose(), to.translation - from.translation});
}

void move(Rigid3& pose, const Twist& twist) {
  const Rigid3 motion = from_twist(twist);
  pose.rotation = nearest_rotation(motion.rotation * pose.rotation);
  pose.translation += motion.translation;
}

}  // namespace

struct BiasAdjustment::Equations {
  using Row = Eigen::Matrix<double, kPairRow, 1>;
  Eigen::Matrix<double, kPairRow, kPairRow> matrix = Eigen::Matrix<double, kPairRow, kPairRow>::Zero();
  Row right = Row::Zero();

  /// Fills the lower half; mirror() copies it to the upper one.
  void add(const Row& row, double residual, double weight) {
    matrix.selfadjointView<Eigen::Lower>().rankUpdate(row, weight);
    right += weight * residual * row;
  }
  void mirror() { matrix.triangularView<Eigen::StrictlyUpper>() = matrix.transpose(); }
};

BiasAdjustment::BiasAdjustment(std::span<const AlignmentTarget> views, int num_threads)
    : views_(views), num_threads_(num_threads) {
  std::vector<double> radii, depths_m;
  for (const AlignmentTarget& view : views) {
    samples_.push_back(draw_samples(view.view->levels[0]));
    for (const Sample& s : samples_.back()) {
      radii.push_back(radius_of(s.point));
      depths_m.push_back(s.point.z());
    }
  }
  middle_radius_ = upper_median(std::move(radii));
  middle_depth_m_ = upper_median(std::move(depths_m));
  for (std::size_t i = 0; i < views.size(); ++i)
    for (std::size_t j = 0; j < views.size(); ++j)
      if (i != j) pairs_.emplace_back(i, j);
}

BiasEstimate BiasAdjustment::solve() const {
  BiasEstimate estimate;
  for (const AlignmentTarget& view : views_) estimate.world_from_camera.push_back(view.world_from_camera);
  for (const double gate_m : kGates_m) step(estimate, ViewPart::kAll, gate_m);
  return estimate;
}

BiasEstimate BiasAdjustment::solve_part(BiasEstimate estimate, ViewPart part) const {
  for (int i = 0; i < kPartSteps; ++i) step(estimate, part, kGates_m.back());
  return estimate;
}

std::vector<BiasAdjustment::Sample> BiasAdjustment::draw_samples(const AlignmentLevel& level) {
  std::vector<std::size_t> usable;
  for (std::size_t i = 0; i < level.points.size(); ++i)
    if (level.points[i].has_normal()) usable.push_back(i);
  const std::size_t step = usable.size() / kMaxBiasSamples + 1;
  std::vector<Sample> samples;
  for (std::size_t k = 0; k < usable.size(); k += step) {
    const AlignmentPoint& p = level.points[usable[k]];
    const double sigma_m = p.sigma_m;
    samples.push_back({p.position.cast<double>(), p.normal.cast<double>(), sigma_m * sigma_m});
  }
  return samples;
}

bool BiasAdjustment::contains(ViewPart part, const Eigen::Vector3d& point) const {
  switch (part) {
    case ViewPart::kAll:
      return true;
    case ViewPart::kCenter:
      return radius_of(point) < middle_radius_;
    case ViewPart::kBorder:
      return radius_of(point) >= middle_radius_;
    case ViewPart::kNear:
      return point.z() < middle_depth_m_;
    case ViewPart::kFar:
      return point.z() >= middle_depth_m_;
    case ViewPart::kLeft:
      return point.x() < 0;
    case ViewPart::kRight:
      return point.x() >= 0;
  }
  return false;
}

// Distances of the points of one view from the surfaces of the other.
BiasAdjustment::Equations BiasAdjustment::compare(const BiasEstimate& estimate, ViewPart part, double gate_m,
                                                  std::pair<std::size_t, std::size_t> pair) const {
  const AlignmentLevel& target = views_[pair.second].view->levels[0];
  const Rigid3& world_from_view = estimate.world_from_camera[pair.first];
  const Rigid3& world_from_target = estimate.world_from_camera[pair.second];
  const Rigid3 view_from_world = world_from_view.inverse();
  const Rigid3 target_from_world = world_from_target.inverse();
  Equations equations;
  for (const Sample& s : samples_[pair.first]) {
    if (!contains(part, s.point)) continue;
    const Eigen::Vector3d p = world_from_view * without_bias(s.point, estimate.per_m);
    const std::optional<Pixel> pixel = target.camera.pixel_of(target_from_world * p);
    if (!pixel) continue;
    const AlignmentPoint& at = target.points(pixel->u, pixel->v);
    if (!at.has_normal()) continue;
    const Eigen::Vector3d measured = at.position.cast<double>();
    if (!contains(part, measured)) continue;
    const Eigen::Vector3d q = world_from_target * without_bias(measured, estimate.per_m);
    const Eigen::Vector3d normal = world_from_target.rotation * at.normal.cast<double>();
    if (normal.dot(world_from_view.rotation * s.normal) < kMinNormalCosine) continue;
    const double sigma_m = at.sigma_m;
    const double variance_m2 = s.variance_m2 + sigma_m * sigma_m;
    const double gate = std::max(gate_m, kGateSigmas * std::sqrt(variance_m2));
    const double distance = normal.dot(p - q);
    if (std::abs(distance) >= gate || (p - q).squaredNorm() > 9 * gate * gate) continue;
    // Derivatives are taken in the middle of the pair. With each view's at its own point, the same noise would be in
    // the derivatives and in the distance, and shift the bias: by 2 cm at 1.2 m in the views of the tests.
    const Eigen::Vector3d middle = 0.5 * (p + q);
    const Eigen::Vector3d from_view = middle - world_from_view.translation;
    const Eigen::Vector3d from_target = middle - world_from_target.translation;
    Equations::Row row;
    row.head<6>() = point_to_plane_row<double>(from_view, normal);
    row.segment<6>(6) = -point_to_plane_row<double>(from_target, normal);
    row[12] = normal.dot(from_view * (view_from_world * middle).z() - from_target * (target_from_world * middle).z());
    equations.add(row, distance,
                  kInformationPerPair * tukey(distance / gate) / (variance_m2 + kUnknownSigma_m * kUnknownSigma_m));
  }
  equations.mirror();
  return equations;
}

// The errors of neighbouring views differ by as much as given motions are off. The first view stays.
void BiasAdjustment::add_given_motions(const BiasEstimate& estimate, Eigen::MatrixXd& matrix,
                                       Eigen::VectorXd& right) const {
  const Twist information = twist_information(kMotionSigma_rad, kMotionSigma_m).diagonal();
  const auto error = [&](std::size_t i) {
    return motion_between(views_[i].world_from_camera, estimate.world_from_camera[i]);
  };
  matrix.diagonal().head<6>() += 1e6 * information;
  for (std::size_t i = 1; i < views_.size(); ++i) {
    const Twist weighted = information.cwiseProduct(error(i) - error(i - 1));
    const auto now = static_cast<Eigen::Index>(6 * i);
    const Eigen::Index before = now - 6;
    matrix.block<6, 6>(now, now).diagonal() += information;
    matrix.block<6, 6>(before, before).diagonal() += information;
    matrix.block<6, 6>(now, before).diagonal() -= information;
    matrix.block<6, 6>(before, now).diagonal() -= information;
    right.segment<6>(now) += weighted;
    right.segment<6>(before) -= weighted;
  }
}

void BiasAdjustment::step(BiasEstimate& estimate, ViewPart part, double gate_m) const {
  std::vector<Equations> compared(pairs_.size());
  parallel_for(pairs_.size(), num_threads_,
               [&](std::size_t k) { compared[k] = compare(estimate, part, gate_m, pairs_[k]); });
  const auto bias_at = static_cast<Eigen::Index>(6 * views_.size());
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(bias_at + 1, bias_at + 1);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(bias_at + 1);
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    std::array<Eigen::Index, kPairRow> at{};
    for (int c = 0; c < 6; ++c) {
      at[c] = static_cast<Eigen::Index>(6 * pairs_[k].first) + c;
      at[6 + c] = static_cast<Eigen::Index>(6 * pairs_[k].second) + c;
    }
    at[12] = bias_at;
    right(at) += compared[k].right;
    matrix(at, at) += compared[k].matrix;
  }
  add_given_motions(estimate, matrix, right);
  matrix(bias_at, bias_at) += 1 / (kPriorSigma_per_m * kPriorSigma_per_m);
  right[bias_at] += estimate.per_m / (kPriorSigma_per_m * kPriorSigma_per_m);
  const Eigen::LDLT<Eigen::MatrixXd> factors(matrix);
  const Eigen::VectorXd change = -factors.solve(right);
  for (std::size_t i = 0; i < views_.size(); ++i)
    move(estimate.world_from_camera[i], change.segment<6>(static_cast<Eigen::Index>(6 * i)));
  estimate.per_m = std::clamp(estimate.per_m + change[bias_at], -kPriorSigma_per_m, kPriorSigma_per_m);
  estimate.sigma_per_m = std::sqrt(factors.solve(Eigen::VectorXd::Unit(bias_at + 1, bias_at))[bias_at]);
}

}  // namespace resight
