#pragma once
#include <ImfIO.h>

#include "write/files.hpp"

namespace synth {

// Lets OpenEXR write through OutputFile, which notices a full disk.
class ExrStream : public Imf::OStream {
 public:
  explicit ExrStream(OutputFile& file) : OStream("image"), file_(file) {}
  void write(const char bytes[], int count) override { file_.write(bytes, static_cast<std::size_t>(count)); }
  std::uint64_t tellp() override { return file_.position(); }
  void seekp(std::uint64_t position) override { file_.seek(position); }

 private:
  OutputFile& file_;
};

}  // namespace synth
