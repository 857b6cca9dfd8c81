// SPDX-License-Identifier: Apache-2.0
#include "resight/simulation/mesh_parts.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "resight/core/check.hpp"

namespace resight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kGutter_px = 8;
constexpr int kAtlasStep_px = 4096;  // by which its height grows
constexpr int kSolid_px = 8;

struct SurfacePoint {
  Vector3d position;
  Vector3d normal;
};

// A grid of (columns x rows) cells over (s, t) in [0, 1]^2. Seen from outside, s points right and t points down.
TriangleMesh make_patch(int columns, int rows, const PixelRect& region,
                        const std::function<SurfacePoint(double, double)>& surface) {
  TriangleMesh mesh;
  for (int j = 0; j <= rows; ++j)
    for (int i = 0; i <= columns; ++i) {
      const double s = static_cast<double>(i) / columns;
      const double t = static_cast<double>(j) / rows;
      const SurfacePoint p = surface(s, t);
      mesh.vertices.push_back(p.position.cast<float>());
      mesh.normals.push_back(p.normal.normalized().cast<float>());
      mesh.uvs.emplace_back(static_cast<float>(region.x + s * region.width),
                            static_cast<float>(region.y + t * region.height));
    }
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const int top_left = j * (columns + 1) + i;
      const int bottom_left = top_left + columns + 1;
      mesh.faces.push_back({top_left, bottom_left, bottom_left + 1});
      mesh.faces.push_back({top_left, bottom_left + 1, top_left + 1});
    }
  return mesh;
}

void drop_degenerate_faces(TriangleMesh& mesh) {
  std::erase_if(mesh.faces, [&](const std::array<int, 3>& f) {
    const Eigen::Vector3f a = mesh.vertices[f[1]] - mesh.vertices[f[0]];
    const Eigen::Vector3f b = mesh.vertices[f[2]] - mesh.vertices[f[0]];
    return a.cross(b).norm() < 1e-12F;
  });
}

struct BoxFace {
  Vector3d right, down;  // Unit vectors as seen from outside.
  PixelRect region;
};

std::vector<BoxFace> box_faces(const BoxRegions& r) {
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  return {{x, -z, r.front}, {y, -z, r.right}, {-x, -z, r.back}, {-y, -z, r.left}, {x, -y, r.top}, {x, y, r.bottom}};
}

}  // namespace

TextureAtlas::TextureAtlas(int width_px, double px_per_mm) : px_per_mm_(px_per_mm), image_(width_px, kAtlasStep_px) {}

PixelRect TextureAtlas::allocate(double width_mm, double height_mm) {
  const auto to_px = [&](double size_mm, int limit_px) {
    return std::clamp(static_cast<int>(std::lround(size_mm * px_per_mm_)), 1, limit_px - 2 * kGutter_px);
  };
  const int w = to_px(width_mm, image_.width());
  const int h = to_px(height_mm, kAtlasStep_px);
  if (x_ + w + 2 * kGutter_px > image_.width()) {
    x_ = 0;
    y_ += row_height_;
    row_height_ = 0;
  }
  if (y_ + h + 2 * kGutter_px > image_.height()) grow();
  const PixelRect region{x_ + kGutter_px, y_ + kGutter_px, w, h};
  x_ += w + 2 * kGutter_px;
  row_height_ = std::max(row_height_, h + 2 * kGutter_px);
  regions_.push_back(region);
  return region;
}

void TextureAtlas::grow() {
  Image<Rgb8> larger(image_.width(), image_.height() + kAtlasStep_px);
  for (int v = 0; v < image_.height(); ++v) std::ranges::copy(image_.row(v), larger.row(v).begin());
  image_ = std::move(larger);
}

PixelRect TextureAtlas::solid(Rgb8 color) {
  const PixelRect region = allocate(kSolid_px / px_per_mm_, kSolid_px / px_per_mm_);
  canvas(region).fill(color);
  return region;
}

void TextureAtlas::finish(TriangleMesh& mesh) {
  const int height = y_ + row_height_;
  Image<Rgb8> texture(image_.width(), height);
  for (int v = 0; v < height; ++v) std::ranges::copy(image_.row(v), texture.row(v).begin());
  for (const PixelRect& r : regions_)
    for (int v = r.y - kGutter_px; v < r.y + r.height + kGutter_px; ++v)
      for (int u = r.x - kGutter_px; u < r.x + r.width + kGutter_px; ++u)
        texture(u, v) = image_(std::clamp(u, r.x, r.x + r.width - 1), std::clamp(v, r.y, r.y + r.height - 1));
  const Eigen::Array2f size(static_cast<float>(image_.width()), static_cast<float>(height));
  for (Eigen::Vector2f& uv : mesh.uvs) uv = uv.array() / size;
  mesh.texture = std::move(texture);
}

TriangleMesh make_box_part(const Vector3d& size, const BoxRegions& regions, int cells) {
  TriangleMesh mesh;
  const Vector3d center(0, 0, size.z() / 2);
  for (const BoxFace& face : box_faces(regions)) {
    const Vector3d normal = face.down.cross(face.right);
    mesh.append(make_patch(cells, cells, face.region, [&](double s, double t) {
      const Vector3d unit = normal * 0.5 + face.right * (s - 0.5) + face.down * (t - 0.5);
      return SurfacePoint{center + unit.cwiseProduct(size), normal};
    }));
  }
  return mesh;
}

TriangleMesh make_rounded_box_part(const Vector3d& size, double radius, const BoxRegions& regions, int cells) {
  TriangleMesh mesh;
  const Vector3d center(0, 0, size.z() / 2);
  const Vector3d core = (size / 2).array() - radius;
  require(core.minCoeff() >= 0, "make_rounded_box_part: the radius is too large");
  // Half of the cells lie in the narrow rounded borders.
  const auto spread = [](double s) { return 0.5 - 0.5 * std::cos(std::numbers::pi * s); };
  for (const BoxFace& face : box_faces(regions)) {
    const Vector3d normal = face.down.cross(face.right);
    mesh.append(make_patch(cells, cells, face.region, [&](double s, double t) {
      const Vector3d unit = normal * 0.5 + face.right * (spread(s) - 0.5) + face.down * (spread(t) - 0.5);
      const Vector3d p = unit.cwiseProduct(size);
      const Vector3d inner = p.cwiseMax(-core).cwiseMin(core);
      const Vector3d direction = (p - inner).normalized();
      return SurfacePoint{center + inner + radius * direction, direction};
    }));
  }
  return mesh;
}

TriangleMesh make_lathe_part(std::span<const Vector2d> profile, const PixelRect& region, int segments) {
  require(profile.size() >= 2, "make_lathe_part: the profile has less than two points");
  std::vector<double> arc(profile.size(), 0.0);
  for (std::size_t i = 1; i < profile.size(); ++i) arc[i] = arc[i - 1] + (profile[i] - profile[i - 1]).norm();
  const int rows = static_cast<int>(profile.size()) - 1;
  TriangleMesh mesh = make_patch(segments, rows, region, [&](double s, double t) {
    const auto i = static_cast<std::size_t>(std::lround(t * rows));
    // From the back (+y) to the left (-x), so that the middle of the region faces the front (-y).
    const double angle = std::numbers::pi / 2 + 2 * std::numbers::pi * s;
    const Vector3d outward(std::cos(angle), std::sin(angle), 0);
    const Vector2d tangent = profile[std::min(i + 1, profile.size() - 1)] - profile[i == 0 ? 0 : i - 1];
    return SurfacePoint{outward * profile[i].x() + Vector3d(0, 0, profile[i].y()),
                        outward * -tangent.y() + Vector3d(0, 0, tangent.x())};
  });
  for (std::size_t i = 0; i < profile.size(); ++i)  // rows are spaced by arc length, not by index
    for (int s = 0; s <= segments; ++s)
      mesh.uvs[i * static_cast<std::size_t>(segments + 1) + s].y() =
          static_cast<float>(region.y + arc[i] / arc.back() * region.height);
  drop_degenerate_faces(mesh);
  return mesh;
}

TriangleMesh make_disc_part(double radius, double z, bool faces_up, const PixelRect& region, double inner_radius,
                            int segments) {
  constexpr int kRings = 6;
  const double side = faces_up ? 1.0 : -1.0;
  TriangleMesh mesh = make_patch(segments, kRings, region, [&](double s, double t) {
    const double r = inner_radius + (radius - inner_radius) * t;
    const double angle = std::numbers::pi / 2 + side * 2 * std::numbers::pi * s;
    return SurfacePoint{Vector3d(r * std::cos(angle), r * std::sin(angle), z), Vector3d(0, 0, side)};
  });
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Eigen::Vector3f& p = mesh.vertices[i];
    mesh.uvs[i] = {static_cast<float>(region.x + (0.5 + 0.5 * p.x() / radius) * region.width),
                   static_cast<float>(region.y + (0.5 - side * 0.5 * p.y() / radius) * region.height)};
  }
  drop_degenerate_faces(mesh);
  return mesh;
}

TriangleMesh make_ellipsoid_part(const Vector3d& radii, const PixelRect& region, int segments) {
  std::vector<Vector2d> profile;
  const int rows = segments / 2;
  for (int i = 0; i <= rows; ++i) {
    const double angle = std::numbers::pi * i / rows;
    profile.emplace_back(std::sin(angle), std::cos(angle));
  }
  profile.front().x() = 0;
  profile.back().x() = 0;
  return scaled(make_lathe_part(profile, region, segments), radii);
}

TriangleMesh make_tube_part(std::span<const Vector3d> path, double radius, const PixelRect& region, int segments) {
  require(path.size() >= 2, "make_tube_part: the path has less than two points");
  const int rows = static_cast<int>(path.size()) - 1;
  const auto tangent = [&](std::size_t i) {
    return Vector3d(path[std::min(i + 1, path.size() - 1)] - path[i == 0 ? 0 : i - 1]).normalized();
  };
  std::vector<Vector3d> sides(path.size());  // transported along the path without twist
  sides[0] = tangent(0).unitOrthogonal();
  for (std::size_t i = 1; i < path.size(); ++i)
    sides[i] = (sides[i - 1] - sides[i - 1].dot(tangent(i)) * tangent(i)).normalized();
  const auto around = [&](std::size_t i, double s) {
    const double angle = 2 * std::numbers::pi * s;
    return Vector3d(std::cos(angle) * sides[i] - std::sin(angle) * tangent(i).cross(sides[i]));
  };
  TriangleMesh mesh = make_patch(segments, rows, region, [&](double s, double t) {
    const auto i = static_cast<std::size_t>(std::lround(t * rows));
    const Vector3d outward = around(i, s);
    return SurfacePoint{path[i] + radius * outward, outward};
  });
  for (const bool at_end : {false, true}) {
    const std::size_t i = at_end ? path.size() - 1 : 0;
    const Vector3d outward = at_end ? tangent(i) : Vector3d(-tangent(i));
    mesh.append(make_patch(segments, 1, region, [&](double s, double t) {
      return SurfacePoint{path[i] + (at_end ? 1 - t : t) * radius * around(i, s), outward};
    }));
  }
  drop_degenerate_faces(mesh);
  return mesh;
}

TriangleMesh make_prism_part(std::span<const Vector2d> polygon, double height, const PixelRect& side,
                             const PixelRect& top, const PixelRect& bottom) {
  require(polygon.size() >= 3, "make_prism_part: the polygon has less than three corners");
  double perimeter = 0;
  Vector2d low = polygon[0];
  Vector2d high = polygon[0];
  Vector2d center = Vector2d::Zero();
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    perimeter += (polygon[(i + 1) % polygon.size()] - polygon[i]).norm();
    low = low.cwiseMin(polygon[i]);
    high = high.cwiseMax(polygon[i]);
    center += polygon[i] / static_cast<double>(polygon.size());
  }
  const auto lift = [](const Vector2d& p, double z) { return Vector3d(p.x(), p.y(), z); };
  TriangleMesh mesh;
  double along = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d& a = polygon[i];
    const Vector2d& b = polygon[(i + 1) % polygon.size()];
    const double length = (b - a).norm();
    const PixelRect part{side.x + static_cast<int>(std::lround(along / perimeter * side.width)), side.y,
                         static_cast<int>(std::lround(length / perimeter * side.width)), side.height};
    along += length;
    const Vector3d normal(b.y() - a.y(), a.x() - b.x(), 0);
    mesh.append(make_patch(8, 12, part, [&](double s, double t) {
      return SurfacePoint{lift(a + s * (b - a), (1 - t) * height), normal};
    }));
    for (const bool is_top : {true, false}) {  // a fan about the centre, as the polygon is star-shaped about it
      const PixelRect& region = is_top ? top : bottom;
      TriangleMesh fan = make_patch(4, 4, region, [&](double s, double t) {
        const Vector2d rim = a + (is_top ? s : 1 - s) * (b - a);
        return SurfacePoint{lift(center + t * (rim - center), is_top ? height : 0.0), Vector3d(0, 0, is_top ? 1 : -1)};
      });
      for (std::size_t k = 0; k < fan.vertices.size(); ++k) {
        const Vector2d q = (fan.vertices[k].head<2>().cast<double>() - low).cwiseQuotient(high - low);
        fan.uvs[k] = {static_cast<float>(region.x + q.x() * region.width),
                      static_cast<float>(region.y + (is_top ? 1 - q.y() : q.y()) * region.height)};
      }
      mesh.append(fan);
    }
  }
  drop_degenerate_faces(mesh);
  return mesh;
}

TriangleMesh moved(TriangleMesh part, const Rigid3& target_from_part) {
  const Rigid3f motion(target_from_part);
  for (auto& v : part.vertices) v = motion * v;
  for (auto& n : part.normals) n = motion.rotation * n;
  return part;
}

TriangleMesh scaled(TriangleMesh part, const Vector3d& factors) {
  require(factors.minCoeff() > 0, "scaled: factors must be > 0");
  const Eigen::Vector3f f = factors.cast<float>();
  for (auto& v : part.vertices) v = v.cwiseProduct(f);
  for (auto& n : part.normals) n = n.cwiseQuotient(f).normalized();
  return part;
}

void make_plain(TriangleMesh& mesh, Rgb8 color) {
  mesh.uvs.clear();
  mesh.texture = {};
  mesh.colors.assign(mesh.vertices.size(), color);
}

void stand_on_origin(TriangleMesh& mesh) {
  Eigen::Vector3f low = mesh.vertices.front();
  Eigen::Vector3f high = low;
  for (const auto& v : mesh.vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  const Eigen::Vector3f base(0.5F * (low.x() + high.x()), 0.5F * (low.y() + high.y()), low.z());
  for (auto& v : mesh.vertices) v -= base;
}

}  // namespace resight
