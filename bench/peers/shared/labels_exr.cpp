#include "shared/labels_exr.hpp"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>

#include <stdexcept>

namespace hybrid::peers {

void write_labels_exr(const std::filesystem::path& file, int rows, int cols,
                      const std::vector<std::uint32_t>& labels) {
  if (rows <= 0 || cols <= 0 ||
      labels.size() != static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols))
    throw std::runtime_error(file.string() + ": expected one label per node of the grid, found " +
                             std::to_string(labels.size()) + " for " + std::to_string(rows) + " x " +
                             std::to_string(cols));
  try {
    Imf::Header header(cols, rows);
    header.compression() = Imf::ZIP_COMPRESSION;
    header.channels().insert("id", Imf::Channel(Imf::UINT));
    Imf::FrameBuffer pixels;
    char* data = reinterpret_cast<char*>(const_cast<std::uint32_t*>(labels.data()));
    pixels.insert("id", Imf::Slice(Imf::UINT, data, 4, 4 * static_cast<std::size_t>(cols)));
    Imf::OutputFile output(file.c_str(), header);
    output.setFrameBuffer(pixels);
    output.writePixels(rows);
  } catch (const std::exception& problem) {
    throw std::runtime_error(file.string() + ": " + problem.what());
  }
}

std::vector<std::uint32_t> read_labels_exr(const std::filesystem::path& file, int rows, int cols) {
  try {
    Imf::InputFile input(file.c_str());
    const auto window = input.header().dataWindow();
    const Imf::Channel* channel = input.header().channels().findChannel("id");
    if (!channel || channel->type != Imf::UINT) throw std::runtime_error("expected a uint channel \"id\"");
    if (window.min.x != 0 || window.min.y != 0 || window.max.x + 1 != cols || window.max.y + 1 != rows)
      throw std::runtime_error("expected " + std::to_string(rows) + " rows and " + std::to_string(cols) +
                               " columns, found " + std::to_string(window.max.y + 1) + " and " +
                               std::to_string(window.max.x + 1));
    std::vector<std::uint32_t> labels(static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols));
    Imf::FrameBuffer pixels;
    pixels.insert("id", Imf::Slice(Imf::UINT, reinterpret_cast<char*>(labels.data()), 4,
                                   4 * static_cast<std::size_t>(cols)));
    input.setFrameBuffer(pixels);
    input.readPixels(window.min.y, window.max.y);
    return labels;
  } catch (const std::exception& problem) {
    throw std::runtime_error(file.string() + ": " + problem.what());
  }
}

void write_result_folder(const std::filesystem::path& out, const std::filesystem::path& range_exr, int rows,
                         int cols, const std::vector<std::uint32_t>& labels) {
  const auto source = std::filesystem::absolute(range_exr);
  const auto folder = out / "scans" / source.parent_path().filename();
  std::filesystem::create_directories(folder);
  const auto link = folder / "range.exr";
  if (std::filesystem::exists(link) && std::filesystem::equivalent(link, source) &&
      !std::filesystem::is_symlink(link))
    throw std::runtime_error(out.string() + ": holds the input; expected a folder of its own");
  std::filesystem::remove(link);
  std::filesystem::create_symlink(source, link);
  write_labels_exr(folder / "labels.exr", rows, cols, labels);
}

}  // namespace hybrid::peers
