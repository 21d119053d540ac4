#include "pictures/functions.hpp"

using namespace hybrid;

// What io/picture_library.cpp looks for.
extern "C" __attribute__((visibility("default"))) const io::PictureLibrary hybrid_picture_library;
const io::PictureLibrary hybrid_picture_library = {io::kPictureInterface,       pictures::read_photograph,
                                                   pictures::check_photograph,  pictures::decode_photograph,
                                                   pictures::picture_size,      pictures::write_jpeg,
                                                   pictures::write_best_jpeg,   pictures::write_tiff,
                                                   pictures::write_values_tiff, pictures::read_depth_image};
