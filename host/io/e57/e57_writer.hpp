#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "io/e57/e57_model.hpp"
#include "io/e57/table_reader.hpp"

namespace hybrid::io {

struct E57WriterOptions {
  std::string guid{};               // of the file; empty: from its scans and images
  std::string coordinate_system{};  // well-known text
  std::vector<E57Extension> extensions{};
  std::optional<double> created_gps_s{};  // seconds of GPS time
  std::size_t records_per_packet = 0;     // 0: as many as fit
  // A copy of another file's tables: fields of any name, with all values that their bits can hold (beyond the
  // field's own limits too).
  bool as_stored = false;
};

// Writes an E57 file: scans block by block, pictures, then the description. The same calls give the same
// bytes: there is no date unless one is given, and identifiers come from the content unless given.
class E57Writer {
 public:
  // `file` is a temporary one of write_atomically(). All functions throw as OutputFile does.
  explicit E57Writer(const std::filesystem::path& file, const E57WriterOptions& options = {});
  ~E57Writer();

  // Starts a scan with what `scan` says, apart from points.count and points.offset. Throws ErrorKind::failed
  // for fields that cannot be written: text, a name that XML does not allow.
  void begin_scan(const E57Scan& scan);
  // Appends records: a column per field in their order, as E57TableReader gives them. Throws
  // ErrorKind::failed naming field and record when a value lies outside the field's limits or, for single
  // precision, is none.
  void write(const E57Records& records);
  std::uint64_t end_scan();  // the offset of its section, as in the file

  // `image` without the places of its blobs; its guid may be empty. The mask may be, too.
  void add_image(const E57Image& image, std::span<const char> picture, std::span<const char> mask = {});

  // Bytes that a description written elsewhere names.
  E57Blob add_blob(std::span<const char> bytes);

  void close();
  // The same with this description, which names the tables and blobs by their offsets, in place of our own.
  void close(const std::string& xml);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace hybrid::io
