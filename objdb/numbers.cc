#include "objdb/numbers.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

#include "objdb/value.h"

namespace objdb {
namespace {

struct OwnBlock : NumberBlock {
  explicit OwnBlock(std::vector<double> own) : vector(std::move(own)) { numbers = vector; }
  std::vector<double> vector;
};

}  // namespace

Numbers::Numbers(std::vector<double> numbers) {
  if (!numbers.empty()) block_ = std::make_shared<OwnBlock>(std::move(numbers));
}

Numbers::Numbers(const Numbers& other) : block_(other.block_) {
  if (block_ && !block_->lasting) *this = Numbers(other.vector());
}

Numbers& Numbers::operator=(const Numbers& other) {
  if (this != &other) *this = Numbers(other);
  return *this;
}

std::uint64_t Numbers::hash() const {
  if (!block_) return hash_numbers({});
  if (!block_->hash || !block_->lasting) block_->hash = hash_numbers(block_->numbers);
  return *block_->hash;
}

bool operator==(const Numbers& a, const Numbers& b) {
  if (a.size() != b.size()) return false;
  return a.empty() || a.data() == b.data() || std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

bool all_finite(std::span<const double> numbers) {
  // what is not finite stays in every sum; eight sums, so that none waits for another
  std::array<double, 8> sum{};
  std::size_t i = 0;
  for (; i + sum.size() <= numbers.size(); i += sum.size())
    for (std::size_t lane = 0; lane < sum.size(); ++lane) sum[lane] += numbers[i + lane];
  for (; i < numbers.size(); ++i) sum[0] += numbers[i];
  double total = 0;
  for (const double each : sum) total += each;
  // only numbers of 1e300 and more have a sum that is not finite though they are
  return std::isfinite(total) ||
         std::all_of(numbers.begin(), numbers.end(), [](double each) { return std::isfinite(each); });
}

std::uint64_t hash_numbers(std::span<const double> numbers) {
  // eight chains, so that no multiplication waits for another. A step of a chain loses nothing (the factor, that of
  // hash_word(), is odd), so two rows that differ in one number never have the same hash
  std::array<std::uint64_t, 8> lane = {0, 1, 2, 3, 4, 5, 6, 7};
  const auto step = [](std::uint64_t& chain, double number) {
    chain = std::rotl((chain ^ std::bit_cast<std::uint64_t>(number)) * 0x9e3779b97f4a7c15ull, 29);
  };
  std::size_t i = 0;
  for (; i + lane.size() <= numbers.size(); i += lane.size())
    for (std::size_t k = 0; k < lane.size(); ++k) step(lane[k], numbers[i + k]);
  for (; i < numbers.size(); ++i) step(lane[0], numbers[i]);
  std::uint64_t hash = numbers.size();
  for (const std::uint64_t each : lane) hash = hash_word(hash, each);
  return hash;
}

}  // namespace objdb
