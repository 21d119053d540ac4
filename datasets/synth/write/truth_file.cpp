#include "write/truth_file.hpp"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "write/exr_stream.hpp"
#include "write/files.hpp"

namespace synth {
namespace {

constexpr std::size_t kWidth = 1024, kRowsAtATime = 256;

struct Record {
  std::uint32_t plane = 0, kind = 0;
  float range = std::numeric_limits<float>::quiet_NaN();
};

}  // namespace

struct TruthFile::Spill {
  OutputFile file;  // never committed: goes away by itself
  std::size_t samples = 0;
};

TruthFile::TruthFile(const std::filesystem::path& path, int rows_of_grid)
    : path_(path), rows_(rows_of_grid), spill_(new Spill{OutputFile(path.string() + ".samples"), 0}) {}

TruthFile::~TruthFile() = default;

void TruthFile::add(const std::vector<Sample>& column) {
  std::vector<Record> records;
  for (const Sample& s : rows_ > 0 ? on_grid(column, rows_) : column)
    records.push_back({s.plane_id, static_cast<std::uint32_t>(s.kind), s.true_range_m});
  spill_->file.write(records.data(), sizeof(Record) * records.size());
  spill_->samples += records.size();
}

void TruthFile::finish() {
  spill_->file.flush();
  std::ifstream spilled(spill_->file.temporary(), std::ios::binary);
  const std::size_t height = std::max<std::size_t>(1, (spill_->samples + kWidth - 1) / kWidth);
  Imf::Header header(static_cast<int>(kWidth), static_cast<int>(height));
  header.compression() = Imf::ZIP_COMPRESSION;
  header.channels().insert("plane", Imf::Channel(Imf::UINT));
  header.channels().insert("range", Imf::Channel(Imf::FLOAT));
  header.channels().insert("kind", Imf::Channel(Imf::UINT));
  OutputFile file(path_);
  {
    ExrStream stream(file);
    Imf::OutputFile image(stream, header);
    std::size_t left = spill_->samples;
    for (std::size_t row = 0; row < height; row += kRowsAtATime) {
      const std::size_t rows = std::min(kRowsAtATime, height - row), count = std::min(left, rows * kWidth);
      std::vector<Record> records(count);
      spilled.read(reinterpret_cast<char*>(records.data()),
                   static_cast<std::streamsize>(sizeof(Record) * count));
      if (!spilled) throw std::runtime_error("cannot read back " + spill_->file.temporary().string());
      records.resize(rows * kWidth);
      left -= count;
      Imf::FrameBuffer pixels;
      const auto channel = [&](const char* name, Imf::PixelType type, void* data) {
        const Imath::Box2i window({0, static_cast<int>(row)},
                                  {static_cast<int>(kWidth) - 1, static_cast<int>(row + rows) - 1});
        pixels.insert(name, Imf::Slice::Make(type, data, window, sizeof(Record), sizeof(Record) * kWidth));
      };
      channel("plane", Imf::UINT, &records[0].plane);
      channel("range", Imf::FLOAT, &records[0].range);
      channel("kind", Imf::UINT, &records[0].kind);
      image.setFrameBuffer(pixels);
      image.writePixels(static_cast<int>(rows));
    }
  }  // which writes the table of its lines
  file.commit();
  spill_.reset();
}

}  // namespace synth
