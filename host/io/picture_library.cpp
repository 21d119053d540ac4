#include "io/picture_library.hpp"

#include <dlfcn.h>

#include <string_view>
#include <tuple>

#include "core/error.hpp"
#include "core/log.hpp"
#include "io/output.hpp"

namespace hybrid::io {
namespace {
namespace fs = std::filesystem;

constexpr const char* kName = "libhybrid_pictures.so";

// What the library uses of the program; the linker would leave out what nothing else in it does.
[[gnu::used]] const std::tuple kUsedByLibrary = {&log::write, &check_readable, &write_atomically};

const PictureLibrary& open_library() {
  std::error_code code;
  const fs::path program = fs::read_symlink("/proc/self/exe", code).parent_path();
  fs::path found = program / kName;
  for (const fs::path& folder : {program, program.parent_path(), program.parent_path() / "lib"})
    if (fs::exists(folder / kName, code)) {
      found = folder / kName;
      break;
    }
  void* const library = dlopen(found.c_str(), RTLD_LAZY | RTLD_LOCAL);
  const auto* const table =
      library ? static_cast<const PictureLibrary*>(dlsym(library, "hybrid_picture_library")) : nullptr;
  const bool other = table && table->interface != std::string_view(kPictureInterface);
  if (!table || other) {
    const char* const reason = other ? "it is of another build" : dlerror();
    fail(ErrorKind::failed,
         "{}: what reads and writes pictures cannot be loaded: {}; keep this library of the same build "
         "beside the "
         "program, and install the packages of datasets/setup.sh",
         found.string(), reason ? reason : "no reason given");
  }
  return *table;
}

}  // namespace

const PictureLibrary& picture_library() {
  static const PictureLibrary& library = open_library();
  return library;
}

}  // namespace hybrid::io
