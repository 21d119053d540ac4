#pragma once
#include <ImfFrameBuffer.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPixelType.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace score {

// A flat OpenEXR image, tiles or lines, its channels in one or several parts. Everything throws InputError
// that names the file.
class ExrFile {
 public:
  explicit ExrFile(const std::filesystem::path& path);

  int width() const { return width_; }
  int height() const { return height_; }
  std::size_t pixels() const { return static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_); }
  bool has(const std::string& channel) const;
  // Decodes these, as far as the file has them, in one pass; one by one every channel would decode all of
  // the file again. The next uints() or floats() of each takes what was decoded.
  void prepare(const std::vector<std::string>& channels);
  std::vector<std::uint32_t> uints(const std::string& channel);
  std::vector<float> floats(const std::string& channel);  // half or float
  std::optional<int> whole_number(const std::string& attribute) const;

 private:
  template <typename T>
  std::vector<T> read(const std::string& channel, Imf::PixelType type);
  void decode(const Imf::FrameBuffer& buffer);
  const Imf::Channel* find(const std::string& channel) const;  // in the first part that has it; or null
  template <typename T>
  Imf::Slice slice(std::vector<T>& values, Imf::PixelType type) const;

  std::filesystem::path path_;
  std::unique_ptr<Imf::MultiPartInputFile> file_;
  std::map<std::string, std::vector<std::uint32_t>> prepared_uints_;
  std::map<std::string, std::vector<float>> prepared_floats_;
  int left_ = 0, top_ = 0, width_ = 0, height_ = 0;
};

}  // namespace score
