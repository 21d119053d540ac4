#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "trace/camera.hpp"
#include "write/e57_pages.hpp"
#include "write/scan_stream.hpp"

namespace synth {

// The frame that the scans' E57 files are in is a surveyor's, not the model's: what reads them has to find
// out by registration. Photographs taken apart from a scan come in a file of their own, in the model's frame.
Eigen::Isometry3d site_from_world();

// A photograph in an E57 file: JPEG bytes, and a PNG mask or none.
struct E57Picture {
  Camera camera;  // world frame; without distortion
  std::string jpeg, mask_png;
};

// ASTM E2807 as its text has it, written apart from host/io so that either can be held against the other.
// Points: x, y, z in steps of 10 micrometres in 26 bits, intensity in 12, row (from the lowest) and column in
// as many as they need; no record without a return. Packets of 2048 records: memory does not grow with the
// scan.
class E57ScanFile : public ScanFile {
 public:
  E57ScanFile(const std::filesystem::path&, const ScannerPose&, const Preset&, std::uint64_t seed);
  void add(const std::vector<Sample>& column) override;
  void attach(E57Picture picture) { pictures_.push_back(std::move(picture)); }  // taken from the scanner
  void finish() override;

 private:
  struct Field {
    std::string name, type;
    std::int64_t minimum, maximum;
    std::string attributes;
    int bits = 0;
    std::uint64_t held = 0;  // bits that fill no byte yet
    int held_bits = 0;
    std::string bytes{};
  };
  void put(std::size_t field, std::int64_t value);
  void write_packet();
  std::string points_xml() const;

  E57Pages pages_;
  ScannerPose pose_;
  std::uint64_t seed_;
  std::vector<Field> fields_;
  std::vector<E57Picture> pictures_;
  Eigen::Vector3d low_, high_;
  std::uint64_t records_ = 0, in_packet_ = 0, column_ = 0, data_offset_ = 0;
  int rows_, columns_;
};

// Photographs alone, in the world's frame.
void write_e57_pictures(const std::filesystem::path&, const std::vector<E57Picture>&, std::uint64_t seed);

}  // namespace synth
