#include "report/previews.hpp"

#include <tbb/task_group.h>

#include <array>
#include <cmath>
#include <deque>
#include <exception>
#include <fstream>
#include <map>
#include <mutex>

#include "core/parallel.hpp"
#include "geometry/colour.hpp"
#include "io/picture.hpp"

namespace hybrid::report {
namespace fs = std::filesystem;
namespace {

constexpr int kPreviewWidth = 1200, kQuality = 88;
constexpr std::size_t kMostPixels = 1 << 26;  // of the pictures in memory, unless one alone has more

// Linear light of a byte in steps of 2^-20: sums of whole numbers are the same in any order.
std::array<std::uint32_t, 256> light_of_bytes() {
  std::array<std::uint32_t, 256> light{};
  for (std::size_t i = 0; i < light.size(); ++i)
    light[i] = static_cast<std::uint32_t>(std::lround(linear_of_bytes<double>()[i] * (1 << 20)));
  return light;
}

// Of a PNG picture, by its header. 0: it is none, as decoding it will tell.
std::size_t pixels_of(const fs::path& file) {
  std::array<unsigned char, 24> head{};
  std::ifstream(file, std::ios::binary).read(reinterpret_cast<char*>(head.data()), head.size());
  const auto number = [&](std::size_t at) {
    return std::size_t{head[at]} << 24 | std::size_t{head[at + 1]} << 16 | std::size_t{head[at + 2]} << 8 |
           head[at + 3];
  };
  return head[1] == 'P' ? number(16) * number(20) : 0;
}

}  // namespace

Image8 shrink(const Image8& picture, int largest_width) {
  const int factor = (picture.width + largest_width - 1) / largest_width;
  if (factor <= 1) return picture;
  static const auto light = light_of_bytes();
  Image8 small((picture.width + factor - 1) / factor, (picture.height + factor - 1) / factor,
               picture.channels);
  parallel_for(static_cast<std::size_t>(small.height), [&](std::size_t row) {
    const int y = static_cast<int>(row);
    const int y_end = std::min((y + 1) * factor, picture.height);
    for (int x = 0; x < small.width; ++x) {
      const int x_end = std::min((x + 1) * factor, picture.width);
      std::array<std::uint64_t, 4> sum{};
      for (int v = y * factor; v < y_end; ++v)
        for (int u = x * factor; u < x_end; ++u)
          for (int k = 0; k < picture.channels; ++k)
            sum[static_cast<std::size_t>(k)] += light[picture.at(u, v)[k]];
      const double count = static_cast<double>(y_end - y * factor) * (x_end - x * factor) * (1 << 20);
      for (int k = 0; k < picture.channels; ++k)
        small.at(x, y)[k] =
            srgb_byte_from_linear(static_cast<double>(sum[static_cast<std::size_t>(k)]) / count);
    }
  });
  return small;
}

struct Previews::Work {
  struct Preview {
    fs::path from, to;
    std::size_t pixels = 0;
  };
  fs::path out;
  std::map<std::string, std::string> preview_of;  // by picture
  tbb::task_group tasks;                          // make_waiting(), a few at once
  std::mutex mutex;                               // of what follows
  std::deque<Preview> waiting;
  std::size_t begun = 0, pixels = 0;  // previews that were; of those that are being made
  int makers = 0;
  std::size_t failed = 0;  // the first of those that failed, by the order in which they began
  std::exception_ptr error;

  // Whether one more may begin: pictures are in memory as a whole, and a large one alone.
  bool may_begin() const {
    return !waiting.empty() && !error && (pixels == 0 || pixels + waiting.front().pixels <= kMostPixels);
  }

  // Called with the mutex held.
  void begin_waiting() {
    if (!may_begin() || makers >= thread_count()) return;
    ++makers;
    tasks.run([this] { make_waiting(); });
  }

  void make_waiting() {
    std::unique_lock lock(mutex);
    while (may_begin()) {
      const Preview preview = std::move(waiting.front());
      waiting.pop_front();
      pixels += preview.pixels;
      const std::size_t number = begun++;
      begin_waiting();
      lock.unlock();
      std::exception_ptr what;
      try {
        io::write_jpeg(preview.to, shrink(io::read_photograph(preview.from, 0, 0), kPreviewWidth), kQuality);
      } catch (...) {
        what = std::current_exception();
      }
      lock.lock();
      pixels -= preview.pixels;
      if (what && (!error || number < failed)) failed = number, error = what;
    }
    --makers;
  }
};

Previews::Previews(fs::path out) : work_(std::make_unique<Work>()) {
  work_->out = std::move(out);
}

Previews::~Previews() {
  work_->tasks.wait();
}

const fs::path& Previews::out() const {
  return work_->out;
}

std::string Previews::of(const std::string& picture) {
  std::error_code ignored;
  if (!fs::is_regular_file(work_->out / picture, ignored)) return "";
  const auto [at, is_new] = work_->preview_of.try_emplace(
      picture, "pictures/" + fs::path(picture).replace_extension(".jpg").generic_string());
  if (!is_new) return at->second;
  const fs::path from = work_->out / picture;
  const std::lock_guard lock(work_->mutex);
  work_->waiting.push_back({from, work_->out / "report" / at->second, pixels_of(from)});
  work_->begin_waiting();
  return at->second;
}

void Previews::finish() {
  work_->tasks.wait();
  if (work_->error) std::rethrow_exception(work_->error);
}

}  // namespace hybrid::report
