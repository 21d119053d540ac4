
#include "core/interrupt.hpp"
#include "io/e57/e57_writer.hpp"
#include "io/exr/exr_e57.hpp"
#include "io/output.hpp"
#include "io/scan_records.hpp"
#include "io/write_scan.hpp"

namespace hybrid::io {

void write_e57(const std::filesystem::path& file, const ScanSource& next) {
  auto scan = next();
  if (!scan) return;
  write_atomically(file, [&](const std::filesystem::path& temporary) {
    E57WriterOptions options;
    options.coordinate_system = scan->head().crs;
    E57Writer writer(temporary, options);
    for (; scan; scan = next()) {
      const ScanRecords records(*scan);
      const E57Table& table = records.description().points;
      writer.begin_scan(records.description());
      for_each_block(records, table, all_fields(table), kBlock_records, [&](const E57Records& block) {
        check_interrupted();
        writer.write(block);
      });
      writer.end_scan();
    }
    writer.close();
  });
}

void write_exr_of_scan(const std::filesystem::path& file, const ScanSource& next) {
  const auto scan = next();
  if (scan) write_exr_scan(ScanAsE57(*scan), 0, file, {});
}

}  // namespace hybrid::io
