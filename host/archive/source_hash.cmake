# Writes OUT: a header with hashes over the names and contents of the sources that results depend on. Any change makes
# other numbers by itself; nobody keeps a version up to date by hand. Two of them, so that a change of the report or of
# the command line does not make thousands of scans' planes anew.
function(hash_of result)
  set(all "")
  foreach(file IN LISTS ARGN)
    file(SHA256 ${SOURCE_DIR}/${file} hash)
    string(APPEND all "${file} ${hash}\n")
  endforeach()
  string(SHA256 hash "${all}")
  string(SUBSTRING ${hash} 0 32 hash)
  set(${result} ${hash} PARENT_SCOPE)
endfunction()

file(GLOB_RECURSE files RELATIVE ${SOURCE_DIR} ${SOURCE_DIR}/host/*.cpp ${SOURCE_DIR}/host/*.hpp
     ${SOURCE_DIR}/kernels/*.cl ${SOURCE_DIR}/kernels/*.h)
list(APPEND files CMakeLists.txt host/CMakeLists.txt kernels/CMakeLists.txt kernels/embed.cmake)
list(SORT files)
hash_of(all ${files})
list(FILTER files EXCLUDE REGEX "^host/(report|app)/")
list(FILTER files EXCLUDE REGEX "^host/archive/[^/]*$")
list(APPEND files host/archive/kept_scan.cpp host/archive/planes_unit.cpp)
hash_of(planes ${files})
file(WRITE ${OUT}.new "// Made by source_hash.cmake.\n#pragma once\n#define HYBRID_ALL_SOURCES \"${all}\"\n"
     "#define HYBRID_PLANES_SOURCES \"${planes}\"\n")
file(COPY_FILE ${OUT}.new ${OUT} ONLY_IF_DIFFERENT)
