#include "fuzz/e57_mutator.hpp"

#include <algorithm>
#include <random>
#include <vector>

#include "io/e57_scans.hpp"

namespace hybrid::testing {
namespace {

constexpr std::size_t kHeader = 48, kPayload = 1020, kPage = 1024;

class Mutation {
 public:
  Mutation(const std::string& file, std::size_t most, unsigned seed, const Mutate& mutate)
      : content_(without_checksums(file)), most_(most), random_(seed), mutate_(mutate) {
    xml_ = std::min(content_.find("<?xml"), content_.size());
    end_ = content_.find_last_not_of('\0') + 1;
  }

  std::string run() {
    const std::size_t kind = below(16);
    if (kind < 4)
      change_word_of_description();
    else if (kind < 7)
      change(xml_, end_, true);
    else if (kind < 14)
      change_section();
    else
      change(0, std::min(kHeader, content_.size()), false);
    if (kind < 15) mend_lengths();  // 15: the header lies
    std::string file = with_checksums(content_);
    if (below(32) == 0) file.resize(below(file.size() + 1));
    if (below(32) == 0 && !file.empty()) file[below(file.size())] ^= static_cast<char>(1 << below(8));
    return file;
  }

 private:
  std::size_t below(std::size_t bound) { return bound == 0 ? 0 : random_() % bound; }

  // Bytes [first, last) by the fuzzer's own mutations.
  void change(std::size_t first, std::size_t last, bool may_grow) {
    if (last <= first) return;
    std::string part = content_.substr(first, last - first);
    const std::size_t size = part.size(), room = most_ / kPage * kPayload;
    const std::size_t most = may_grow && room > content_.size() ? size + room - content_.size() : size;
    part.resize(most);
    part.resize(mutate_(part.data(), size, most));
    if (!may_grow) part.resize(size);
    content_.replace(first, size, part);
    end_ = end_ - size + part.size();
  }

  // Some bytes of the binary sections, which keep their places; often those that packet headers hold.
  void change_section() {
    if (xml_ <= kHeader) return;
    const std::size_t first = kHeader + below((xml_ - kHeader + 3) / 4) * 4;
    if (below(3) > 0) {
      change(first, std::min(xml_, first + (std::size_t{1} << below(7))), false);
      return;
    }
    static const std::size_t kWords[] = {0, 1, 2, 3, 4, 7, 8, 31, 32, 33, 255, 65535, 65534};
    const std::size_t word = kWords[below(std::size(kWords))], at = first + 2 * below(2);
    for (std::size_t i = 0; i < 2 && at + i < xml_; ++i)
      content_[at + i] = static_cast<char>(word >> (8 * i));
  }

  // One run of letters or digits becomes another word that means something.
  void change_word_of_description() {
    static const char* const kWords[] = {"0",
                                         "-1",
                                         "1",
                                         "7",
                                         "8",
                                         "63",
                                         "1e308",
                                         "-1e308",
                                         "nan",
                                         "inf",
                                         "1e-320",
                                         "9223372036854775807",
                                         "-9223372036854775808",
                                         "18446744073709551615",
                                         "4294967296",
                                         "255",
                                         "1000000",
                                         "Integer",
                                         "ScaledInteger",
                                         "Float",
                                         "String",
                                         "Structure",
                                         "single",
                                         "double",
                                         "cartesianX",
                                         "rowIndex",
                                         "columnIndex",
                                         "sphericalRange",
                                         "intensity",
                                         "colorRed",
                                         "returnIndex",
                                         "cartesianInvalidState",
                                         "",
                                         "48"};
    const auto is_word = [](char c) {
      return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' ||
             c == '.';
    };
    if (end_ <= xml_) return;
    std::size_t first = xml_ + below(end_ - xml_);
    while (first < end_ && !is_word(content_[first])) ++first;
    while (first > xml_ && first < end_ && is_word(content_[first - 1])) --first;
    std::size_t last = first;
    while (last < end_ && is_word(content_[last])) ++last;
    const std::string word = kWords[below(std::size(kWords))];
    if (content_.size() - (last - first) + word.size() > most_ / kPage * kPayload) return;
    content_.replace(first, last - first, word);
    end_ = end_ - (last - first) + word.size();
  }

  void mend_lengths() {
    if (content_.size() < kHeader || xml_ < kHeader || end_ <= xml_) return;
    content_.resize(end_);
    const std::uint64_t pages = (end_ + kPayload - 1) / kPayload;
    content_.replace(0, 8, "ASTM-E57");
    content_.replace(16, 8, little_endian(std::uint64_t{kPage * pages}));
    content_.replace(24, 8, little_endian(std::uint64_t{xml_ + 4 * (xml_ / kPayload)}));
    content_.replace(32, 8, little_endian(std::uint64_t{end_ - xml_}));
  }

  std::string content_;
  std::size_t most_, xml_ = 0, end_ = 0;
  std::minstd_rand random_;
  const Mutate& mutate_;
};

}  // namespace

std::string mutated_e57(const std::string& file, std::size_t most, unsigned seed, const Mutate& mutate) {
  if (file.size() < kPage || seed % 64 == 0) {
    std::string bytes = file;
    bytes.resize(most);
    bytes.resize(mutate(bytes.data(), file.size(), most));
    return bytes;
  }
  std::string result = Mutation(file, most, seed, mutate).run();
  if (result.size() > most) result.resize(most);
  return result;
}

}  // namespace hybrid::testing
