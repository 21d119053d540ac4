#include "io/exr/exr_dwa.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "io/scalar_type.hpp"
#include "io/text/text_cursor.hpp"

namespace hybrid::io {
namespace {

// The numbers, of 64 bits each, that a chunk begins with.
enum Number {
  kVersion,
  kPlain,
  kPlainPacked,
  kCosinesPacked,
  kMeansPacked,
  kRunsPacked,
  kRunsUnpacked,
  kRuns,
  kCosines,
  kMeans,
  kCosinesCoding,
  kNumbers
};
constexpr std::size_t kHeadBytes = 8 * kNumbers;

enum Scheme { kAsItIs, kAsCosines, kAsRuns };

struct Rule {
  std::string name;                        // the last part of a channel's
  int scheme = kAsItIs, type = Imf::HALF;  // any number, in a damaged file
  bool any_case = true;
};

// Of versions 0 and 1, which have none in the file.
std::vector<Rule> early_rules() {
  std::vector<Rule> rules;
  for (const char* name : {"r", "red", "g", "grn", "green", "b", "blu", "blue", "y", "by", "ry"})
    for (const auto type : {Imf::HALF, Imf::FLOAT}) rules.push_back({name, kAsCosines, type});
  for (const auto type : {Imf::UINT, Imf::HALF, Imf::FLOAT}) rules.push_back({"a", kAsRuns, type});
  return rules;
}

// A name, a zero, a byte with the scheme in bits 2 and 3 and "any case" in bit 0, the pixels' type. Where
// they end too early, the library says so.
std::vector<Rule> read_rules(std::string_view text) {
  std::vector<Rule> rules;
  for (std::size_t end; (end = text.find('\0')) != text.npos && end + 2 < text.size();
       text.remove_prefix(end + 3)) {
    const auto how = static_cast<unsigned char>(text[end + 1]);
    rules.push_back({std::string(text.substr(0, end)), how >> 2 & 3, text[end + 2], (how & 1) != 0});
  }
  return rules;
}

// The last rule that fits counts.
int scheme_of(const std::vector<Rule>& rules, std::string_view channel, Imf::PixelType type) {
  const std::string_view name = channel.substr(channel.rfind('.') + 1);
  int scheme = kAsItIs;
  for (const Rule& rule : rules)
    if (rule.type == type && (rule.any_case ? lower_case(name) == rule.name : name == rule.name))
      scheme = rule.scheme;
  return scheme;
}

}  // namespace

ExrChunkBytes dwa_chunk_bytes(const Imf::ChannelList& channels, const ExrChunkBox& box,
                              std::span<const char> chunk) {
  std::uint64_t all = 0;
  for (auto at = channels.begin(); at != channels.end(); ++at) all += exr_samples(at.channel(), box).bytes();
  if (chunk.size() < kHeadBytes) return {all, 0};
  const auto number = [&](Number which) {
    return load_as<std::uint64_t>(chunk.data() + 8 * static_cast<std::size_t>(which), false);
  };

  std::size_t begin = kHeadBytes;
  std::vector<Rule> rules = early_rules();
  if (number(kVersion) >= 2) {
    if (chunk.size() < kHeadBytes + 2) return {all, 0};
    const std::size_t size = load_as<std::uint16_t>(chunk.data() + kHeadBytes, false);
    begin += size;
    if (size < 2 || chunk.size() < begin) return {all, 0};
    rules = read_rules({chunk.data() + kHeadBytes + 2, size - 2});
  }

  ExrChunkBytes plain, means, runs;
  bool light = false;
  for (auto at = channels.begin(); at != channels.end(); ++at) {
    const ExrSamples samples = exr_samples(at.channel(), box);
    const int scheme = scheme_of(rules, at.name(), at.channel().type);
    if (scheme == kAsCosines) {
      // Of whole numbers the library writes but half of the bytes.
      if (at.channel().type == Imf::UINT) return {samples.bytes(), samples.bytes() / 2};
      means.expected += 2 * ((samples.wide + 7) / 8) * ((samples.high + 7) / 8);
      light |= samples.bytes() > 0;
    } else {
      (scheme == kAsRuns ? runs : plain).expected += samples.bytes();
    }
  }

  const std::uint64_t packed = std::min<std::uint64_t>(number(kPlainPacked), chunk.size() - begin);
  if (packed > 0) plain.found = exr_inflated_bytes(chunk.subspan(begin, packed), plain.expected);
  plain.found = std::min(plain.found, number(kPlain));
  means.found = number(kMeansPacked) > 0 ? 2 * number(kMeans) : 0;
  if (light && number(kCosinesPacked) == 0) means.found = 0;
  runs.found = number(kRuns);
  for (const ExrChunkBytes& kind : {plain, means, runs})
    if (kind.found < kind.expected) return kind;
  return runs;
}

}  // namespace hybrid::io
