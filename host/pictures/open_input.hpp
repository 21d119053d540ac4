#pragma once
#include <OpenImageIO/imageio.h>

#include <filesystem>
#include <memory>
#include <string>

namespace hybrid::pictures {

// OpenImageIO's own words on one line, for the tail of a message.
std::string reason(std::string message);

// The picture in a file; input_error where it is none that can be read. OpenImageIO takes what follows a `?`
// in a name for options: files of such names are opened by the reader that their extension asks for.
std::unique_ptr<OIIO::ImageInput> open_input(const std::filesystem::path& file,
                                             const OIIO::ImageSpec& configuration = {});

}  // namespace hybrid::pictures
