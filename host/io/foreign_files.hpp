#pragma once
#include <filesystem>
#include <string>
#include <string_view>

namespace hybrid::io {

// The extension (".las") that a file's first bytes say it should have, of formats that begin with bytes of
// their own; "" of all others, and of files that cannot be opened.
std::string_view extension_by_content(const std::filesystem::path& file);

// What to do with a file whose extension (lower case, with its dot) is that of no scan: scanners' own
// formats, texts, models, archives of files.
std::string advice_on(std::string_view extension);

}  // namespace hybrid::io
