// SPDX-License-Identifier: Apache-2.0
#include "resight/rendering/color_camera.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "resight/core/parallel.hpp"
#include "resight/core/random.hpp"
#include "resight/core/srgb.hpp"
#include "resight/rendering/internal/jpeg_quantization.hpp"

namespace resight {
namespace {

using Eigen::Vector3f;

constexpr std::uint64_t kViewStream = ~1ULL;  // rows use the streams from 0
constexpr float kSharpeningSigma_px = 1.0F;

// Value at a pixel; outside, the image is mirrored, so that the pattern of the mosaic continues.
template <typename T>
const T& mirrored(const Image<T>& image, int u, int v) {
  const auto mirror = [](int x, int size) {
    if (size == 1) return 0;
    if (x < 0) x = -x;
    return x >= size ? std::max(0, 2 * size - 2 - x) : x;
  };
  return image(mirror(u, image.width()), mirror(v, image.height()));
}

template <typename T, typename Value>
Image<T> map_pixels(int width, int height, int num_threads, const Value& value) {
  Image<T> result(width, height, value(0, 0));
  parallel_for(static_cast<std::size_t>(height), num_threads, [&](std::size_t v) {
    for (int u = 0; u < width; ++u) result(u, static_cast<int>(v)) = value(u, static_cast<int>(v));
  });
  return result;
}

template <typename T>
Image<T> blur(const Image<T>& image, float sigma_px, int num_threads) {
  const int radius = std::max(1, static_cast<int>(std::ceil(2.5F * sigma_px)));
  std::vector<float> weights;
  float total = 0;
  for (int i = -radius; i <= radius; ++i) {
    weights.push_back(std::exp(-0.5F * static_cast<float>(i * i) / (sigma_px * sigma_px)));
    total += weights.back();
  }
  const auto pass = [&](const Image<T>& source, int du, int dv) {
    return map_pixels<T>(source.width(), source.height(), num_threads, [&](int u, int v) {
      T sum = weights[radius] / total * source(u, v);
      for (int i = 1; i <= radius; ++i)
        sum += weights[radius + i] / total *
               (mirrored(source, u + i * du, v + i * dv) + mirrored(source, u - i * du, v - i * dv));
      return sum;
    });
  };
  return pass(pass(image, 1, 0), 0, 1);
}

// Averages over a straight path of the image, sampled at steps of about half a pixel.
LightImage blur_by_motion(const LightImage& light, const Eigen::Vector2f& path_px, int num_threads) {
  const int steps = static_cast<int>(std::ceil(2 * path_px.norm()));
  if (steps < 1) return light;
  return map_pixels<Vector3f>(light.width(), light.height(), num_threads, [&](int u, int v) {
    Vector3f sum = Vector3f::Zero();
    for (int i = 0; i <= steps; ++i) {
      const Eigen::Vector2f offset = (static_cast<float>(i) / static_cast<float>(steps) - 0.5F) * path_px;
      const int du = static_cast<int>(std::floor(offset.x()));
      const int dv = static_cast<int>(std::floor(offset.y()));
      const float ax = offset.x() - static_cast<float>(du);
      const float ay = offset.y() - static_cast<float>(dv);
      sum += (1 - ay) * ((1 - ax) * mirrored(light, u + du, v + dv) + ax * mirrored(light, u + du + 1, v + dv)) +
             ay * ((1 - ax) * mirrored(light, u + du, v + dv + 1) + ax * mirrored(light, u + du + 1, v + dv + 1));
    }
    return Vector3f(sum / static_cast<float>(steps + 1));
  });
}

float exposure_of(const LightImage& light, const ExposureControl& control) {
  if (control.metering <= 0) return static_cast<float>(control.factor);
  double sum = 0;
  for (const Vector3f& c : light.data()) sum += std::min(1.0F, c.mean());
  const double mean = std::max(1e-3, sum / static_cast<double>(light.size()));
  return static_cast<float>(control.factor * std::pow(control.metering_target / mean, control.metering));
}

// Factors of the automatic white balance on the channels.
Vector3f white_balance_of(const LightImage& light, const ExposureControl& control) {
  if (control.white_balancing <= 0) return Vector3f::Ones();
  Eigen::Vector3d sum = Eigen::Vector3d::Constant(1e-6);
  for (const Vector3f& c : light.data()) sum += c.cwiseMin(1.0F).cast<double>();
  const auto factor = [&](int channel) {
    return static_cast<float>(std::pow(sum.y() / sum[channel], control.white_balancing));
  };
  return {factor(0), 1, factor(2)};
}

// The channel that a pixel of the Bayer pattern RGGB measures.
int mosaic_channel(int u, int v) { return (u % 2 + v % 2); }

void add_sensor_noise(LightImage& light, const ColorCamera& camera, std::uint64_t seed, int num_threads) {
  if (camera.read_noise <= 0 && camera.shot_noise <= 0) return;
  const auto read_sq = static_cast<float>(camera.read_noise * camera.read_noise);
  const auto shot_sq = static_cast<float>(camera.shot_noise * camera.shot_noise);
  const auto noisy = [&](float x, Rng& rng) {
    return x + std::sqrt(read_sq + shot_sq * std::max(0.0F, x)) * static_cast<float>(rng.normal());
  };
  parallel_for(static_cast<std::size_t>(light.height()), num_threads, [&](std::size_t row) {
    Rng rng = Rng::stream(seed, row);
    const int v = static_cast<int>(row);
    for (int u = 0; u < light.width(); ++u) {
      Vector3f& c = light(u, v);
      if (camera.mosaic) {  // the other channels of the pixel are not used
        float& x = c[mosaic_channel(u, v)];
        x = noisy(x, rng);
      } else {
        for (float& x : c) x = noisy(x, rng);
      }
    }
  });
}

// Interpolates each channel from the nearest pixels that measure it.
LightImage demosaic(const LightImage& mosaic, int num_threads) {
  return map_pixels<Vector3f>(mosaic.width(), mosaic.height(), num_threads, [&](int u, int v) {
    Vector3f result;
    for (int channel = 0; channel < 3; ++channel) {
      float sum = 0, total = 0;
      for (int dv = -1; dv <= 1; ++dv)
        for (int du = -1; du <= 1; ++du) {
          if (mosaic_channel((u + du) & 1, (v + dv) & 1) != channel) continue;
          const bool is_own = du == 0 && dv == 0;
          if (!is_own && mosaic_channel(u & 1, v & 1) == channel) continue;
          // Green has four neighbours along the axes; red and blue have two or four, all equally far.
          sum += mirrored(mosaic, u + du, v + dv)[channel];
          total += 1;
        }
      result[channel] = sum / total;
    }
    return result;
  });
}

float apply_contrast(float encoded, float contrast) {
  const float x = std::clamp(encoded / 255, 0.0F, 1.0F);
  return 255 * ((1 - contrast) * x + contrast * x * x * (3 - 2 * x));
}

// A bilateral filter whose weight falls rationally with the difference, which is cheaper than a Gaussian.
LightImage reduce_noise(const LightImage& image, float grey_levels, int num_threads) {
  constexpr int kRadius = 2;
  return map_pixels<Vector3f>(image.width(), image.height(), num_threads, [&](int u, int v) {
    const Vector3f& center = image(u, v);
    Vector3f sum = Vector3f::Zero();
    float total = 0;
    for (int dv = -kRadius; dv <= kRadius; ++dv)
      for (int du = -kRadius; du <= kRadius; ++du) {
        const Vector3f& other = mirrored(image, u + du, v + dv);
        const float ratio_sq = (other - center).squaredNorm() / (3 * grey_levels * grey_levels);
        const float weight = 1 / ((1 + ratio_sq * ratio_sq) * (1 + 0.25F * static_cast<float>(du * du + dv * dv)));
        sum += weight * other;
        total += weight;
      }
    return Vector3f(sum / total);
  });
}

float brightness_of(const Vector3f& c) { return 0.299F * c.x() + 0.587F * c.y() + 0.114F * c.z(); }

void sharpen(LightImage& image, float amount, int num_threads) {
  const auto luma = map_pixels<float>(image.width(), image.height(), num_threads,
                                      [&](int u, int v) { return brightness_of(image(u, v)); });
  const Image<float> soft = blur(luma, kSharpeningSigma_px, num_threads);
  for (std::size_t i = 0; i < image.size(); ++i) image[i].array() += amount * (luma[i] - soft[i]);
}

void saturate(LightImage& image, float factor) {
  for (Vector3f& c : image.data()) {
    const float grey = brightness_of(c);
    c = (grey + factor * (c.array() - grey)).matrix();
  }
}

// From light to the encoded image of the sensor without its processing.
LightImage expose(const LightImage& light, const ColorCamera& camera, const Vector3f& gains, std::uint64_t seed,
                  int num_threads) {
  Rng rng = Rng::stream(seed, kViewStream);
  const auto draw_path = [&] { return static_cast<float>(camera.motion_blur_px * rng.normal()); };
  const float path_u = draw_path();
  const Eigen::Vector2f path_px(path_u, draw_path());
  const Vector3f white(static_cast<float>(camera.exposure.red_gain), 1, static_cast<float>(camera.exposure.blue_gain));
  const Vector3f factors = exposure_of(light, camera.exposure) *
                           gains.cwiseProduct(white).cwiseProduct(white_balance_of(light, camera.exposure));
  LightImage image = light;
  for (Vector3f& c : image.data()) c = c.cwiseProduct(factors).cwiseMin(4.0F);  // stray light of lamps stays bounded
  if (camera.blur_px > 0) image = blur(image, static_cast<float>(camera.blur_px), num_threads);
  if (camera.motion_blur_px > 0) image = blur_by_motion(image, path_px, num_threads);
  add_sensor_noise(image, camera, seed, num_threads);
  for (Vector3f& c : image.data()) c = c.cwiseMax(0.0F).cwiseMin(1.0F);
  return camera.mosaic ? demosaic(image, num_threads) : image;
}

}  // namespace

Image<Rgb8> develop_color(const LightImage& light, const ColorCamera& camera, const Vector3f& gains, std::uint64_t seed,
                          int num_threads) {
  camera.check();
  LightImage image = expose(light, camera, gains, seed, num_threads);
  const auto contrast = static_cast<float>(camera.contrast);
  image = map_pixels<Vector3f>(image.width(), image.height(), num_threads, [&](int u, int v) {
    return Vector3f(image(u, v).unaryExpr([&](float x) { return apply_contrast(encode_srgb(x), contrast); }));
  });
  if (camera.noise_reduction > 0) image = reduce_noise(image, static_cast<float>(camera.noise_reduction), num_threads);
  if (camera.sharpening > 0) sharpen(image, static_cast<float>(camera.sharpening), num_threads);
  if (camera.saturation != 1) saturate(image, static_cast<float>(camera.saturation));
  if (camera.jpeg_quality < 100) {
    for (Vector3f& c : image.data()) c = c.cwiseMax(0.0F).cwiseMin(255.0F);
    quantize_as_jpeg(image, camera.jpeg_quality, num_threads);
  }
  const auto round = [](float x) { return static_cast<std::uint8_t>(std::clamp(x + 0.5F, 0.0F, 255.0F)); };
  return map_pixels<Rgb8>(image.width(), image.height(), num_threads, [&](int u, int v) {
    const Vector3f& c = image(u, v);
    return Rgb8{round(c.x()), round(c.y()), round(c.z())};
  });
}

}  // namespace resight
