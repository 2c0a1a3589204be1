#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace render {

/// Width and height in pixels.
struct Size {
  int width = 0;
  int height = 0;
  bool operator==(const Size&) const = default;
};

/// The largest picture side accepted anywhere [pixels]: the texture limit of the software rasterizer.
inline constexpr int largest_side = 16384;
/// The largest picture accepted anywhere [pixels], so that a typing error cannot exhaust the memory.
inline constexpr long long largest_area = 1LL << 26;

/// Empty if `size` can be drawn, otherwise the sentence that says why not.
std::string size_problem(Size size);

/// An 8-bit colour, not premultiplied.
using Rgba = std::array<std::uint8_t, 4>;

/// An image: rows top to bottom, 4 bytes RGBA a pixel, sRGB.
class Picture {
 public:
  Picture() = default;
  explicit Picture(Size size, Rgba fill = {0, 0, 0, 255});

  Size size() const { return size_; }
  int width() const { return size_.width; }
  int height() const { return size_.height; }
  std::uint8_t* data() { return bytes_.data(); }
  const std::uint8_t* data() const { return bytes_.data(); }
  /// width * height * 4
  std::size_t byte_count() const { return bytes_.size(); }
  Rgba at(int x, int y) const;
  void put(int x, int y, Rgba color);
  /// Changes the size; the content is then undefined.
  void resize(Size size);

 private:
  Size size_;
  std::vector<std::uint8_t> bytes_;
};

/// Writes a PNG through a temporary file beside it, so that a reader never sees half a picture.
/// Returns an empty string, or what went wrong.
std::string write_png(const Picture& picture, const std::string& path);

/// Reads a PNG of any colour type. Returns an empty string, or what went wrong.
std::string read_png(const std::string& path, Picture& picture);

/// Copies `from` into `into` with its upper left corner at (x, y), clipped.
void paste(const Picture& from, Picture& into, int x, int y);

/// A frame of `thickness` pixels drawn inside the given rectangle, clipped.
void outline(Picture& into, int x, int y, Size size, int thickness, Rgba color);

/// `from` at another size: the mean of the covered area when smaller, bilinear when larger.
Picture resized(const Picture& from, Size size);

/// How different two pictures look.
struct Difference {
  bool same_size = true;
  double mean = 0;   ///< mean over blurred cells of the colour distance in CIE Lab (about 2.3 is just noticeable)
  double worst = 0;  ///< the largest cell
};

/// A tolerant comparison: both pictures are averaged over cells of `cell` pixels, which forgives single-pixel edges
/// and rounding, then compared by the CIE 1976 colour difference.
Difference difference(const Picture& a, const Picture& b, int cell = 8);

}  // namespace render
