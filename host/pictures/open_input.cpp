#include "pictures/open_input.hpp"

#include "core/error.hpp"
#include "io/output.hpp"

namespace hybrid::pictures {

std::string reason(std::string message) {
  for (char& c : message)
    if (c == '\n' || c == '\r') c = ' ';
  return message.empty() ? "no reason given" : message;
}

std::unique_ptr<OIIO::ImageInput> open_input(const std::filesystem::path& file,
                                             const OIIO::ImageSpec& configuration) {
  io::check_readable(file);
  const std::string name = file.string();
  std::unique_ptr<OIIO::ImageInput> input;
  std::string words;
  if (name.find('?') == std::string::npos) {
    input = OIIO::ImageInput::open(name, &configuration);
  } else if (std::string format = file.extension().string();
             !format.empty() && (input = OIIO::ImageInput::create(format.substr(1)))) {
    OIIO::ImageSpec spec;
    if (!input->open(name, spec, configuration)) {
      words = input->geterror();
      input.reset();
    }
  }
  if (!input)
    fail_input("{}: is no picture that can be read: {}", name,
               reason(words.empty() ? OIIO::geterror() : words));
  return input;
}

}  // namespace hybrid::pictures
