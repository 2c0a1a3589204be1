#include "manipulators/render/smooth.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

namespace render {

namespace {

// brightness differences below this are no edge: an absolute step of 3.5 %, or 9 % of the brighter side
constexpr int least_step = 9;
constexpr int share_of_bright = 11;  // 1/11 = 9 %
constexpr int longest_walk = 8;      // pixels

// brightness 0..255 with weights 77 150 29 / 256 (Rec. 601)
void brightness_row(const std::uint8_t* rgba, std::uint8_t* out, int width) {
  for (int x = 0; x < width; ++x) {
    out[x] = static_cast<std::uint8_t>((77 * rgba[4 * x] + 150 * rgba[4 * x + 1] + 29 * rgba[4 * x + 2]) >> 8);
  }
}

// 1 where the cross of five pixels holds a step
void edge_row(const std::uint8_t* above, const std::uint8_t* own, const std::uint8_t* below, std::uint8_t* edge,
              int width) {
  for (int x = 1; x < width - 1; ++x) {
    const std::uint8_t low = std::min({own[x], above[x], below[x], own[x - 1], own[x + 1]});
    const std::uint8_t high = std::max({own[x], above[x], below[x], own[x - 1], own[x + 1]});
    const std::uint8_t wanted = std::max<std::uint8_t>(least_step, static_cast<std::uint8_t>(high * 23 >> 8));
    edge[x] = static_cast<std::uint8_t>(high - low) >= wanted;
  }
}

static_assert(256 / 23 == share_of_bright);

}  // namespace

void smooth_edges(Picture& picture) {
  const int width = picture.width();
  const int height = picture.height();
  if (width < 3 || height < 3) return;
  const std::size_t row_bytes = static_cast<std::size_t>(width) * 4;
  std::vector<std::uint8_t> luma(static_cast<std::size_t>(width) * height);
  for (int y = 0; y < height; ++y) {
    brightness_row(picture.data() + row_bytes * y, luma.data() + static_cast<std::size_t>(width) * y, width);
  }
  // the original of the rows that are being changed: the one before and the current one
  std::vector<std::uint8_t> before(picture.data(), picture.data() + row_bytes);
  std::vector<std::uint8_t> current(row_bytes);
  std::vector<std::uint8_t> edge(width);

  for (int y = 1; y < height - 1; ++y) {
    const std::uint8_t* own = luma.data() + static_cast<std::size_t>(width) * y;
    std::uint8_t* target = picture.data() + row_bytes * y;
    std::memcpy(current.data(), target, row_bytes);
    edge_row(own - width, own, own + width, edge.data(), width);

    for (int x = 1; x < width - 1; ++x) {
      if (!edge[x]) continue;
      const std::uint8_t* at = own + x;
      const int m = *at, n = at[-width], s = at[width], w = at[-1], e = at[1];
      const int nw = at[-width - 1], ne = at[-width + 1], sw = at[width - 1], se = at[width + 1];
      // is the edge level? then blend with the pixel above or below
      const int across_y = 2 * std::abs(n + s - 2 * m) + std::abs(ne + se - 2 * e) + std::abs(nw + sw - 2 * w);
      const int across_x = 2 * std::abs(e + w - 2 * m) + std::abs(ne + nw - 2 * n) + std::abs(se + sw - 2 * s);
      const bool level = across_y >= across_x;
      const int first = level ? n : w;
      const int second = level ? s : e;
      const bool toward_first = std::abs(first - m) >= std::abs(second - m);
      const int other = toward_first ? first : second;
      const int step = (toward_first ? -1 : 1) * (level ? width : 1);
      const int along = level ? 1 : width;

      // walk both ways between the two pixels until the pair's mean leaves the edge's
      const int room_back = level ? x : y;
      const int room_ahead = level ? width - 1 - x : height - 1 - y;
      const int twice_edge = m + other;
      const int contrast = std::abs(other - m) / 2;
      int back = 0, ahead = 0, back_excess = 0, ahead_excess = 0;
      while (back < std::min(longest_walk, room_back)) {
        ++back;
        back_excess = at[-back * along] + at[step - back * along] - twice_edge;
        if (std::abs(back_excess) >= contrast) break;
      }
      while (ahead < std::min(longest_walk, room_ahead)) {
        ++ahead;
        ahead_excess = at[ahead * along] + at[step + ahead * along] - twice_edge;
        if (std::abs(ahead_excess) >= contrast) break;
      }
      const int nearest_excess = back < ahead ? back_excess : ahead_excess;
      float shift = 0;
      if ((nearest_excess < 0) != (m < other) && back + ahead > 0) {
        shift = 0.5f - static_cast<float>(std::min(back, ahead)) / static_cast<float>(back + ahead);
      }
      // single pixels that stick out are softened too
      const int high = std::max({m, n, s, w, e});
      const int low = std::min({m, n, s, w, e});
      const float mean = static_cast<float>(2 * (n + s + e + w) + nw + ne + sw + se) / 12;
      float stick = std::min(1.0f, std::abs(mean - static_cast<float>(m)) / static_cast<float>(high - low));
      stick = stick * stick * (3 - 2 * stick);
      shift = std::max(shift, stick * stick * 0.6f);

      const std::uint8_t* mine = current.data() + 4 * x;
      const std::uint8_t* theirs = !level         ? mine + 4 * step
                                   : toward_first ? before.data() + 4 * x
                                                  : target + row_bytes + 4 * x;
      for (int c = 0; c < 3; ++c) {
        const float a = mine[c];
        target[4 * x + c] = static_cast<std::uint8_t>(a + shift * (static_cast<float>(theirs[c]) - a) + 0.5f);
      }
    }
    std::swap(before, current);
  }
}

}  // namespace render
