#include "report/previews.hpp"

#include <tbb/task_group.h>

#include <array>
#include <cmath>
#include <deque>
#include <exception>
#include <map>
#include <mutex>
#include <optional>
#include <utility>

#include "core/parallel.hpp"
#include "geometry/colour.hpp"
#include "io/picture.hpp"

namespace hybrid::report {
namespace fs = std::filesystem;
namespace {

constexpr int kPreviewWidth = 1200, kQuality = 88;

// Linear light of a byte in steps of 2^-20: sums of whole numbers are the same in any order.
std::array<std::uint32_t, 256> light_of_bytes() {
  std::array<std::uint32_t, 256> light{};
  for (std::size_t i = 0; i < light.size(); ++i)
    light[i] =
        static_cast<std::uint32_t>(std::lround(linear_from_srgb(static_cast<double>(i) / 255) * (1 << 20)));
  return light;
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
  };
  fs::path out;
  std::map<std::string, std::string> preview_of;  // by picture
  tbb::task_group tasks;                          // make_waiting(), once at a time
  std::mutex mutex;                               // of what follows
  std::deque<Preview> waiting;
  bool making = false;
  std::exception_ptr error;

  std::optional<Preview> next() {
    const std::lock_guard lock(mutex);
    making = !waiting.empty() && !error;
    if (!making) return std::nullopt;
    Preview first = std::move(waiting.front());
    waiting.pop_front();
    return first;
  }

  void make_waiting() {
    while (const auto preview = next()) try {
        io::write_jpeg(preview->to, shrink(io::read_photograph(preview->from, 0, 0), kPreviewWidth),
                       kQuality);
      } catch (...) {
        const std::lock_guard lock(mutex);
        error = std::current_exception();
      }
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
  const std::lock_guard lock(work_->mutex);
  work_->waiting.push_back({work_->out / picture, work_->out / "report" / at->second});
  if (!std::exchange(work_->making, true)) work_->tasks.run([work = work_.get()] { work->make_waiting(); });
  return at->second;
}

void Previews::finish() {
  work_->tasks.wait();
  if (work_->error) std::rethrow_exception(work_->error);
}

}  // namespace hybrid::report
