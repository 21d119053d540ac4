#include <algorithm>
#include <memory>
#include <vector>

#include "core/error.hpp"
#include "core/scratch_file.hpp"
#include "io/built_stream.hpp"
#include "io/fixed_records.hpp"
#include "io/pcd/lzf.hpp"
#include "io/pcd/pcd.hpp"
#include "io/pcd/pcd_file.hpp"
#include "io/text/text_stream.hpp"

namespace hybrid::io {
namespace {

class PcdTextStream : public TextStream {
 public:
  PcdTextStream(const std::filesystem::path& file, const ScanEntry& entry, std::unique_ptr<PcdFile> opened)
      : TextStream(file, entry), file_(std::move(opened)) {
    add_notes(file_->notes());
    const auto notes = take({.start = {file_->data, file_->header.data_line},
                             .count = file_->header.points,
                             .columns = file_->header.point_values,
                             .intensity = file_->used.intensity != nullptr,
                             .colour = file_->used.colour()});
    add_notes(file_->notes_of_rest(after(), commas_seen()));
    add_notes(notes);
    file_->set_grid_and_pose(head_);
  }

 private:
  ScanSample sample(const double* row) const override { return pcd_sample_of_row(file_->used, row); }
  void read_line(TextCursor& cursor, std::span<double> values, std::uint64_t done) const override {
    file_->read_line(cursor, values, done);
  }

  std::unique_ptr<PcdFile> file_;
};

class PcdRecordStream : public BuiltStream {
 public:
  PcdRecordStream(const ScanEntry& entry, std::unique_ptr<PcdFile> opened)
      : BuiltStream(entry),
        file_(std::move(opened)),
        records_(file_->input, file_->data, file_->header.point_bytes) {
    count_ = file_->header.points;
    intensity_ = file_->used.intensity != nullptr;
    exact_ = entry.exact && file_->rounds();
    add_notes(file_->notes());
    take_first(records_.first_pass(count_, file_->used.colour(), FromPcdRecord{file_->used}));
    add_notes(file_->notes_of_rest(count_ * file_->header.point_bytes));
    add_notes(take(file_->name, false));
    file_->set_grid_and_pose(head_);
  }

 private:
  void add(std::uint64_t first, std::size_t count, ScanBuilder& builder) const override {
    with_colours(builder, [&](auto& to) { records_.add(first, count, to, FromPcdRecord{file_->used}); });
  }

  std::unique_ptr<PcdFile> file_;
  mutable FixedRecords records_;
};

// Compressed points, whose fields lie one behind the other, decompressed into a file.
class PcdFieldStream : public BuiltStream {
 public:
  PcdFieldStream(const ScanEntry& entry, std::unique_ptr<PcdFile> opened, PcdFile::Sizes sizes,
                 std::unique_ptr<ScratchFile> fields)
      : BuiltStream(entry), file_(std::move(opened)), fields_(std::move(fields)) {
    const PcdUsedFields& used = file_->used;
    for (const PcdField* field :
         {used.x, used.y, used.z, used.intensity, used.packed, used.red, used.green, used.blue})
      if (field) columns_.push_back({field, {}});
    count_ = file_->header.points;
    intensity_ = used.intensity != nullptr;
    exact_ = entry.exact && file_->rounds();
    add_notes(file_->notes());
    FirstPass pass;
    pass.colour = used.colour();
    for (std::uint64_t done = 0; done < count_ && !pass.done(); done += kBlock)
      add_fields(done, static_cast<std::size_t>(std::min<std::uint64_t>(kBlock, count_ - done)), pass);
    take_first(pass);
    add_notes(file_->notes_of_rest(8 + sizes.compressed));
    add_notes(take(file_->name, false));
    file_->set_grid_and_pose(head_);
  }

  // Null where there is no room for it.
  static std::unique_ptr<ScratchFile> decompress(const PcdFile& file, PcdFile::Sizes sizes) {
    auto fields = ScratchFile::make(sizes.expanded);
    std::uint64_t done = 0;
    const std::string damage = !fields ? ""
                                       : decompress_lzf(file.input, file.data + 8, sizes.compressed,
                                                        sizes.expanded, [&](std::span<const char> piece) {
                                                          const bool written = fields->write(done, piece);
                                                          done += piece.size();
                                                          if (!written) fields = nullptr;
                                                          return written;
                                                        });
    if (!damage.empty()) file.fail_compressed(damage);
    return fields;
  }

 private:
  struct Column {
    const PcdField* field;
    std::vector<char> bytes;
  };

  void add(std::uint64_t first, std::size_t count, ScanBuilder& builder) const override {
    with_colours(builder, [&](auto& to) { add_fields(first, count, to); });
  }

  template <typename Builder>
  void add_fields(std::uint64_t first, std::size_t count, Builder& builder) const {
    for (Column& column : columns_) {
      const std::size_t size = size_of(column.field->type);
      column.bytes.resize(count * size);
      if (!fields_->read(count_ * column.field->byte_offset + first * size, column.bytes))
        fail(ErrorKind::failed,
             "{}: expected to read what was decompressed into a scratch file in {}, found it unreadable; is "
             "the disk damaged?",
             file_->name, scratch_folder().string());
    }
    builder.add_parts({count}, [&](std::size_t, std::size_t i) {
      return pcd_sample_in_memory(file_->used, [&](const PcdField& field) {
        const auto column = std::ranges::find(columns_, &field, &Column::field);
        return column->bytes.data() + i * size_of(field.type);
      });
    });
  }

  std::unique_ptr<PcdFile> file_;
  std::unique_ptr<ScratchFile> fields_;
  mutable std::vector<Column> columns_;
};

}  // namespace

std::unique_ptr<ScanStream> stream_pcd(const std::filesystem::path& file, const ScanEntry& entry) {
  if (entry.salvage) return nullptr;
  auto opened = std::make_unique<PcdFile>(file, false);
  if (opened->header.data == PcdData::binary_compressed) {
    const auto sizes = opened->compressed_sizes();
    auto fields = PcdFieldStream::decompress(*opened, sizes);
    if (!fields) return nullptr;
    return std::make_unique<PcdFieldStream>(entry, std::move(opened), sizes, std::move(fields));
  }
  if (opened->header.data == PcdData::binary && opened->header.point_bytes > FixedRecords::kLongest_bytes)
    return nullptr;
  opened->bound_points();
  if (opened->header.data == PcdData::ascii)
    return std::make_unique<PcdTextStream>(file, entry, std::move(opened));
  return std::make_unique<PcdRecordStream>(entry, std::move(opened));
}

}  // namespace hybrid::io
