// A libhybrid_pictures.so as of another build of the program: what it offers is not what this one asks for.
extern "C" __attribute__((visibility("default"))) const char* const hybrid_picture_library[32];
const char* const hybrid_picture_library[32] = {"another build's"};
