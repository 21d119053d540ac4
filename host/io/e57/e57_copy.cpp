#include <algorithm>
#include <map>
#include <numeric>

#include "core/interrupt.hpp"
#include "io/e57/e57_source.hpp"
#include "io/e57/e57_writer.hpp"
#include "io/output.hpp"

namespace hybrid::io {
namespace {

std::uint64_t copy_table(const E57Source& source, std::size_t part, E57Writer& writer) {
  E57Scan scan;
  scan.points = source.table(part);
  writer.begin_scan(scan);
  for_each_block(*source.open(part), scan.points, all_fields(scan.points), kBlock_records,
                 [&](const E57Records& records) {
                   check_interrupted();
                   writer.write(records);
                 });
  return writer.end_scan();
}

}  // namespace

void copy_e57(const E57Source& source, const std::filesystem::path& file) {
  const std::vector<E57Part>& parts = source.outline().parts;
  // In the order that they had: a file of our own writer's comes out as it was.
  std::vector<std::size_t> order(parts.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&](std::size_t part) { return parts[part].offset; });
  write_atomically(file, [&](const std::filesystem::path& temporary) {
    E57Writer writer(temporary, {.as_stored = true});
    std::vector<TextEdit> offsets;
    std::map<std::uint64_t, std::uint64_t> blobs;  // one that two pictures name is written once
    for (const std::size_t part : order) {
      std::uint64_t at = 0;
      if (!parts[part].blob)
        at = copy_table(source, part, writer);
      else if (const auto known = blobs.find(parts[part].offset); known != blobs.end())
        at = known->second;
      else
        at = blobs[parts[part].offset] = writer.add_blob(source.blob(part)).offset;
      offsets.push_back({parts[part].offset_text, std::to_string(at)});
    }
    writer.close(edited(source.xml(), std::move(offsets)));
  });
}

}  // namespace hybrid::io
