#include "score/read/exr_file.hpp"

#include <ImfChannelList.h>
#include <ImfHeader.h>
#include <ImfInputPart.h>
#include <ImfIntAttribute.h>

#include "score/error.hpp"
#include "score/read/files.hpp"

namespace score {
namespace {

constexpr double kMostPixels = 2e9;  // a damaged header must not ask for all the memory there is

}  // namespace

ExrFile::ExrFile(const std::filesystem::path& path) : path_(path) {
  check_file(path);
  try {
    file_ = std::make_unique<Imf::MultiPartInputFile>(path.c_str());
    const auto window = file_->header(0).dataWindow();
    left_ = window.min.x;
    top_ = window.min.y;
    const double width = 1.0 + window.max.x - window.min.x, height = 1.0 + window.max.y - window.min.y;
    if (width < 1 || height < 1 || width * height > kMostPixels)
      bad_input("{}: header: expected an image, found {} x {} pixels; the file is damaged: write it again",
                path.string(), width, height);
    width_ = static_cast<int>(width);
    height_ = static_cast<int>(height);
    for (int part = 0; part < file_->parts(); ++part) {
      if (file_->header(part).dataWindow() != window)
        bad_input("{}: header: expected all parts of one size, found others; write it again", path.string());
      if (file_->partComplete(part)) continue;
      bad_input("{}: expected all tiles, found some missing; the file is cut short: write it again",
                path.string());
    }
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& problem) {
    bad_input("{}: expected an OpenEXR image, found something else ({}); write it again", path.string(),
              problem.what());
  }
}

const Imf::Channel* ExrFile::find(const std::string& channel) const {
  for (int part = 0; part < file_->parts(); ++part)
    if (const auto* found = file_->header(part).channels().findChannel(channel)) return found;
  return nullptr;
}

bool ExrFile::has(const std::string& channel) const {
  return find(channel) != nullptr;
}

template <typename T>
Imf::Slice ExrFile::slice(std::vector<T>& values, Imf::PixelType type) const {
  values.resize(pixels());
  const std::size_t row = sizeof(T) * static_cast<std::size_t>(width_);
  return Imf::Slice(type,
                    reinterpret_cast<char*>(values.data()) - static_cast<std::ptrdiff_t>(sizeof(T)) * left_ -
                        static_cast<std::ptrdiff_t>(row) * top_,
                    sizeof(T), row);
}

void ExrFile::decode(const Imf::FrameBuffer& buffer) {
  try {
    for (int i = 0; i < file_->parts(); ++i) {
      const auto& channels = file_->header(i).channels();
      Imf::FrameBuffer own;  // the library fills slices of other channels with zeros
      for (auto at = buffer.begin(); at != buffer.end(); ++at) {
        const auto* channel = channels.findChannel(at.name());
        if (channel != nullptr && channel == find(at.name())) own.insert(at.name(), at.slice());
      }
      if (own.begin() == own.end()) continue;
      Imf::InputPart part(*file_, i);
      part.setFrameBuffer(own);
      part.readPixels(top_, top_ + height_ - 1);
    }
  } catch (const std::exception& problem) {
    std::string names;
    for (auto at = buffer.begin(); at != buffer.end(); ++at)
      names += (names.empty() ? "" : "\", \"") + std::string(at.name());
    bad_input("{}: channel \"{}\" cannot be read ({}); the file is damaged: write it again", path_.string(),
              names, problem.what());
  }
}

void ExrFile::prepare(const std::vector<std::string>& channels) {
  Imf::FrameBuffer buffer;
  for (const auto& name : channels) {
    const Imf::Channel* channel = find(name);
    if (!channel || channel->xSampling != 1 || channel->ySampling != 1) continue;  // read() says so
    buffer.insert(name, channel->type == Imf::UINT ? slice(prepared_uints_[name], Imf::UINT)
                                                   : slice(prepared_floats_[name], Imf::FLOAT));
  }
  decode(buffer);
}

template <typename T>
std::vector<T> ExrFile::read(const std::string& name, Imf::PixelType type) {
  const Imf::Channel* channel = find(name);
  const bool counts = channel && channel->type == Imf::UINT;
  if (!channel || counts != (type == Imf::UINT) || channel->xSampling != 1 || channel->ySampling != 1)
    bad_input("{}: expected a channel \"{}\" of {} numbers, found {}; SCENE.md's Outputs name the channels",
              path_.string(), name, type == Imf::UINT ? "whole" : "real",
              channel ? "another kind" : "no such channel");
  std::vector<T> values;
  Imf::FrameBuffer buffer;
  buffer.insert(name, slice(values, type));
  decode(buffer);
  return values;
}

std::vector<std::uint32_t> ExrFile::uints(const std::string& channel) {
  if (auto found = prepared_uints_.extract(channel)) return std::move(found.mapped());
  return read<std::uint32_t>(channel, Imf::UINT);
}

std::vector<float> ExrFile::floats(const std::string& channel) {
  if (auto found = prepared_floats_.extract(channel)) return std::move(found.mapped());
  return read<float>(channel, Imf::FLOAT);
}

std::optional<int> ExrFile::whole_number(const std::string& attribute) const {
  const auto* found = file_->header(0).findTypedAttribute<Imf::IntAttribute>(attribute);
  return found ? std::optional<int>(found->value()) : std::nullopt;
}

}  // namespace score
