#include "manipulators/render/picture.h"

#include <png.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>

namespace render {

std::string size_problem(Size size) {
  if (size.width < 1 || size.height < 1 || size.width > largest_side || size.height > largest_side) {
    return "a picture side must be 1 to " + std::to_string(largest_side) + " pixels, not " +
           std::to_string(size.width) + "x" + std::to_string(size.height);
  }
  if (static_cast<long long>(size.width) * size.height > largest_area) {
    return "a picture must have at most " + std::to_string(largest_area) + " pixels, not " +
           std::to_string(size.width) + "x" + std::to_string(size.height);
  }
  return {};
}

Picture::Picture(Size size, Rgba fill) {
  resize(size);
  for (std::size_t i = 0; i < bytes_.size(); i += 4) std::copy(fill.begin(), fill.end(), bytes_.begin() + i);
}

void Picture::resize(Size size) {
  size_ = size;
  bytes_.resize(static_cast<std::size_t>(size.width) * size.height * 4);
}

Rgba Picture::at(int x, int y) const {
  const std::uint8_t* p = bytes_.data() + (static_cast<std::size_t>(y) * size_.width + x) * 4;
  return {p[0], p[1], p[2], p[3]};
}

void Picture::put(int x, int y, Rgba color) {
  if (x < 0 || y < 0 || x >= size_.width || y >= size_.height) return;
  std::copy(color.begin(), color.end(), bytes_.data() + (static_cast<std::size_t>(y) * size_.width + x) * 4);
}

std::string write_png(const Picture& picture, const std::string& path) {
  if (auto problem = size_problem(picture.size()); !problem.empty()) return problem;
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = picture.width();
  image.height = picture.height();
  image.format = PNG_FORMAT_RGBA;
  // a fast setting compresses nearly as well on rendered pictures and takes a third of the time
  image.flags = PNG_IMAGE_FLAG_FAST;

  // what lies there is the rest of a picture that was cut off, or a trap: a link to something else of ours
  const std::string partial = path + ".part";
  std::error_code none;
  if (std::filesystem::is_symlink(partial, none)) std::filesystem::remove(partial, none);
  if (!png_image_write_to_file(&image, partial.c_str(), 0, picture.data(), 0, nullptr)) {
    std::string why = image.message;
    std::error_code ignored;
    std::filesystem::remove(partial, ignored);
    return "cannot write '" + path + "': " + why;
  }
  if (std::rename(partial.c_str(), path.c_str()) != 0) {
    std::string why = std::strerror(errno);
    std::error_code ignored;
    std::filesystem::remove(partial, ignored);
    return "cannot write '" + path + "': " + why;
  }
  return {};
}

std::string read_png(const std::string& path, Picture& picture) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_file(&image, path.c_str())) return "cannot read '" + path + "': " + image.message;
  image.format = PNG_FORMAT_RGBA;
  Size size{static_cast<int>(image.width), static_cast<int>(image.height)};
  if (auto problem = size_problem(size); !problem.empty()) {
    png_image_free(&image);
    return "cannot read '" + path + "': " + problem;
  }
  picture.resize(size);
  if (!png_image_finish_read(&image, nullptr, picture.data(), 0, nullptr)) {
    return "cannot read '" + path + "': " + image.message;
  }
  return {};
}

void paste(const Picture& from, Picture& into, int x, int y) {
  const int left = std::max(0, -x);
  const int right = std::min(from.width(), into.width() - x);
  if (right <= left) return;
  for (int row = std::max(0, -y); row < from.height() && y + row < into.height(); ++row) {
    const std::uint8_t* source = from.data() + (static_cast<std::size_t>(row) * from.width() + left) * 4;
    std::uint8_t* target = into.data() + (static_cast<std::size_t>(y + row) * into.width() + x + left) * 4;
    std::memcpy(target, source, static_cast<std::size_t>(right - left) * 4);
  }
}

void outline(Picture& into, int x, int y, Size size, int thickness, Rgba color) {
  for (int row = 0; row < size.height; ++row) {
    for (int column = 0; column < size.width; ++column) {
      const int edge = std::min({row, column, size.height - 1 - row, size.width - 1 - column});
      if (edge < thickness) into.put(x + column, y + row, color);
    }
  }
}

namespace {

// weights with which source samples make up one target sample along one axis
struct Taps {
  int first = 0;
  std::vector<float> weights;
};

std::vector<Taps> taps_of(int source, int target) {
  std::vector<Taps> taps(target);
  const double ratio = static_cast<double>(source) / target;
  // a triangle as wide as the larger of the two pixel sizes
  const double reach = std::max(1.0, ratio);
  for (int i = 0; i < target; ++i) {
    const double centre = (i + 0.5) * ratio - 0.5;
    const int first = std::clamp(static_cast<int>(std::ceil(centre - reach)), 0, source - 1);
    const int last = std::clamp(static_cast<int>(std::floor(centre + reach)), first, source - 1);
    taps[i].first = first;
    double sum = 0;
    for (int k = first; k <= last; ++k) {
      const double weight = std::max(1e-6, 1 - std::abs(k - centre) / reach);
      taps[i].weights.push_back(static_cast<float>(weight));
      sum += weight;
    }
    for (float& weight : taps[i].weights) weight = static_cast<float>(weight / sum);
  }
  return taps;
}

}  // namespace

Picture resized(const Picture& from, Size size) {
  Picture to(size);
  if (from.width() == 0 || from.height() == 0) return to;
  const auto across = taps_of(from.width(), size.width);
  const auto down = taps_of(from.height(), size.height);

  // first the rows, then the columns
  std::vector<float> rows(static_cast<std::size_t>(size.width) * from.height() * 4);
  for (int y = 0; y < from.height(); ++y) {
    for (int x = 0; x < size.width; ++x) {
      const std::uint8_t* source = from.data() + (static_cast<std::size_t>(y) * from.width() + across[x].first) * 4;
      float* sum = rows.data() + (static_cast<std::size_t>(y) * size.width + x) * 4;
      for (std::size_t k = 0; k < across[x].weights.size(); ++k) {
        for (int c = 0; c < 4; ++c) sum[c] += across[x].weights[k] * source[k * 4 + c];
      }
    }
  }
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      float sum[4] = {0, 0, 0, 0};
      for (std::size_t k = 0; k < down[y].weights.size(); ++k) {
        const float* source = rows.data() + (static_cast<std::size_t>(down[y].first + k) * size.width + x) * 4;
        for (int c = 0; c < 4; ++c) sum[c] += down[y].weights[k] * source[c];
      }
      std::uint8_t* target = to.data() + (static_cast<std::size_t>(y) * size.width + x) * 4;
      for (int c = 0; c < 4; ++c) target[c] = static_cast<std::uint8_t>(std::clamp(sum[c] + 0.5f, 0.0f, 255.0f));
    }
  }
  return to;
}

namespace {

struct Lab {
  double l, a, b;
};

// CIE 1976 L*a*b* of an sRGB colour under D65 (IEC 61966-2-1 primaries)
Lab lab_of(const double rgb[3]) {
  double linear[3];
  for (int c = 0; c < 3; ++c) {
    const double v = rgb[c] / 255;
    linear[c] = v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
  }
  const double x = (0.4124564 * linear[0] + 0.3575761 * linear[1] + 0.1804375 * linear[2]) / 0.95047;
  const double y = 0.2126729 * linear[0] + 0.7151522 * linear[1] + 0.0721750 * linear[2];
  const double z = (0.0193339 * linear[0] + 0.1191920 * linear[1] + 0.9503041 * linear[2]) / 1.08883;
  auto f = [](double t) { return t > 216.0 / 24389 ? std::cbrt(t) : (24389.0 / 27 * t + 16) / 116; };
  return {116 * f(y) - 16, 500 * (f(x) - f(y)), 200 * (f(y) - f(z))};
}

Lab mean_lab(const Picture& picture, int x0, int y0, int cell) {
  double sum[3] = {0, 0, 0};
  int count = 0;
  for (int y = y0; y < std::min(y0 + cell, picture.height()); ++y) {
    for (int x = x0; x < std::min(x0 + cell, picture.width()); ++x) {
      const Rgba p = picture.at(x, y);
      for (int c = 0; c < 3; ++c) sum[c] += p[c];
      ++count;
    }
  }
  for (double& s : sum) s /= count;
  return lab_of(sum);
}

}  // namespace

Difference difference(const Picture& a, const Picture& b, int cell) {
  Difference result;
  if (a.size() != b.size()) {
    result.same_size = false;
    result.mean = result.worst = 100;
    return result;
  }
  double sum = 0;
  int count = 0;
  for (int y = 0; y < a.height(); y += cell) {
    for (int x = 0; x < a.width(); x += cell) {
      const Lab p = mean_lab(a, x, y, cell);
      const Lab q = mean_lab(b, x, y, cell);
      const double distance = std::hypot(p.l - q.l, p.a - q.a, p.b - q.b);
      sum += distance;
      result.worst = std::max(result.worst, distance);
      ++count;
    }
  }
  result.mean = count ? sum / count : 0;
  return result;
}

}  // namespace render
